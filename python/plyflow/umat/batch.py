"""The batch routine of a scene (NAME_batch.f90): generated and compiled for the CPU at hand when a batch first wants it."""

from __future__ import annotations

import ctypes
import functools
import platform
from pathlib import Path

from plyflow.errors import ToolError
from plyflow.umat.compile import compile_batch, generate_batch_cached
from umatgen.scene import Scene, SceneError

# No contraction to multiply-and-add: J - 1 times kappa would differ from the scalar routine by 1e-10. Vector functions of glibc
# come with -O3 and need no -ffast-math in Fortran.
BATCH_FLAGS: tuple[str, ...] = (
    "-O3", "-fPIC", "-std=gnu", "-frecursive", "-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off",
    "-march=native",
)  # fmt: skip


class BatchRoutine:
    """The batch routine of a scene, made when its address is first asked for.

    Parameters
    ----------
    scene : its scene.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._missing = scene.without_batch

    @property
    def says(self) -> str:
        """With which flags batches run in blocks of points, or why they do not."""
        return self._missing or f"in blocks, {' '.join(BATCH_FLAGS)}"

    @functools.cached_property
    def address(self) -> int:
        """Address of the routine; 0 where the scene has none or the compiler refuses it, `says` then tells why."""
        if self._missing:
            return 0
        try:
            library = ctypes.CDLL(str(compile_batch(generate_batch_cached(self.scene), BATCH_FLAGS, cpu())))
            routine = library[f"pfb_{self.scene.name}_batch_"]
        except (ToolError, SceneError, OSError, AttributeError) as error:
            self._missing = f"points go one by one: {error}"
            return 0
        return int(ctypes.cast(routine, ctypes.c_void_p).value or 0)


@functools.lru_cache
def cpu() -> str:
    """What tells this machine's CPU from others for -march=native: its name and its features."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").split("\n\n")[0].splitlines()
    except OSError:
        lines = []
    told = [line for line in lines if line.split(":")[0].strip() in ("model name", "flags", "Features", "CPU part")]
    return "\n".join([platform.machine(), *told])
