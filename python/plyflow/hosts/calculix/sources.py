"""The sources of a scene's CalculiX faces as files, for those who compile them themselves."""

from __future__ import annotations

from plyflow.hosts.calculix.faces import (
    ADAPTER,
    ADAPTER_SYMBOL,
    STANDINS,
    library_name,
    native_material,
    native_text,
    own_source,
)
from plyflow.umat.prepare import generate_scene
from plyflow.umat.scenes import find_scene

README = """CalculiX faces of the scene {scene}

Both need a CalculiX built with external materials ('plyflow calculix build'). The library has to lie where the
loader looks, for instance in the job's folder with LD_LIBRARY_PATH=. in front of ccx.

Native door (use this one: stress and stiffness straight from the deformation gradients, knows *ORIENTATION)
  gfortran -O2 -fPIC -shared -fopenmp {standins} {scene}_native.for -o lib{library}.so
  *MATERIAL, NAME={native}

Adapter: the Abaqus UMAT behind the @ABAQUSNL_ door (not with *ORIENTATION)
  gfortran -O2 -fPIC -shared -fopenmp {standins} {adapter} {scene}.for -o lib{library}NL.so
  *MATERIAL, NAME=@ABAQUSNL_{library}NL_{symbol}

Constants and state variables: as listed at the head of {scene}_native.for.
"""


def face_files(scene: str) -> dict[str, str]:
    """Name and text of the files of a scene's faces.

    Raises
    ------
    InputError
        Unknown scene, or one without a native face.
    """
    source, manifest, _ = generate_scene(scene)
    name = str(manifest["name"])
    described = find_scene(scene)
    readme = README.format(
        scene=name,
        library=library_name(described),
        native=native_material(described),
        standins=STANDINS,
        adapter=ADAPTER,
        symbol=ADAPTER_SYMBOL,
    )
    return {
        f"{name}_native.for": native_text(described),
        f"{name}.for": source,
        STANDINS: own_source(STANDINS),
        ADAPTER: own_source(ADAPTER),
        "README.txt": readme,
    }
