"""Sources of scenes compiled as they are, and with errors planted in them."""

from plyflow.umat.compile import FLAGS, compile_umat
from plyflow.umat.library import UmatLibrary
from umatgen.pipeline import generate
from umatgen.scene import SCENES, Scene


def compiled(source: str, *errors: tuple[str, str], flags: tuple[str, ...] = tuple(FLAGS)) -> UmatLibrary:
    """Library of a source, with each text of it exchanged for another: planted errors."""
    for old, new in errors:
        assert old in source, f"the emitted source has no text {old}"
        source = source.replace(old, new)
    return UmatLibrary(compile_umat(source, flags))


def emit(scene: str | Scene = "bdf1") -> str:
    """Source of a scene, of a shipped one by its name."""
    return generate(SCENES[scene] if isinstance(scene, str) else scene).source
