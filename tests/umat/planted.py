"""Sources of scenes compiled as they are, and with errors planted in them."""

from typing import Any

from oracle import State, crossing_states, random_states
from oracle.compare import Errors, umat_errors
from plyflow.umat.compile import FLAGS, compile_umat
from plyflow.umat.library import UmatLibrary
from umatgen.pipeline import generate
from umatgen.scene import SCENES, Scene

STRESS_TOLERANCE, DDSDDE_TOLERANCE = 1.0e-12, 1.0e-9
REGIMES = ("squeeze", "across", "bleed")


def drawn(regime: str, seed: int, count: int, *more: Any, **options: Any) -> list[State]:
    """Random increments before the lock, across it or after it; some load, some unload."""
    if regime == "across":
        return crossing_states(seed, count)
    return random_states(seed, count, regime == "bleed", *more, **options)


def worst(library: UmatLibrary, states: list[State]) -> Errors:
    """Largest errors over states."""
    errors = umat_errors(library, states)
    return Errors(max(e.stress for e in errors), max(e.ddsdde for e in errors))


def compiled(source: str, *errors: tuple[str, str], flags: tuple[str, ...] = tuple(FLAGS)) -> UmatLibrary:
    """Library of a source, with each text of it exchanged for another: planted errors."""
    for old, new in errors:
        assert old in source, f"the emitted source has no text {old}"
        source = source.replace(old, new)
    return UmatLibrary(compile_umat(source, flags))


def emit(scene: str | Scene = "bdf1") -> str:
    """Source of a scene, of a shipped one by its name."""
    return generate(SCENES[scene] if isinstance(scene, str) else scene).source
