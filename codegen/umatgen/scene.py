"""A scene: what the generated UMAT keeps. Frozen and validated; everything not kept is left out of the source."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass

from umatgen.model.constraint import DEVICES
from umatgen.model.tangent import TANGENTS


class SceneError(ValueError):
    """A scene asks for something that is not known or does not fit together."""


@dataclass(frozen=True)
class Scene:
    """Description of one UMAT.

    Parameters
    ----------
    name : name of the scene, of the file and (prefixed with pf_) of every procedure in it.
    tangent : "consistent" (everything differentiated, not symmetric), "paper" (Eq. 16 as meant, f frozen) or
        "symmetric" (symmetric part of the consistent one).
    invariants : "transverse" (always real) or "printed" (Eqs. 13-14 in I1 and I3: NaN in general states).
    incompressibility : "penalty", or "augmented" (pressure carried over in a state variable).
    lock : "instant" (landed on through PNEWDT) or "blend" (C1 over `blend_width` of logarithmic strain).
    first_tangent : tangent at vanishing rate: "last_rate" (the secant viscosity at the last converged rate, so that a
        first iteration without extrapolation lands near the solution) or "floor" (that of the rate floor).
    procedures : "internal" (inside the point routine, so that compilers inline them) or "external" (each stage a symbol of
        its own that a test or an audit can call; the same text otherwise).
    landing_tolerance : half width in logarithmic strain of the band around eps_lock that counts as the lock.

    Raises
    ------
    SceneError
        Names the field, the value, what is allowed.
    """

    name: str = "default"
    tangent: str = "consistent"
    invariants: str = "transverse"
    incompressibility: str = "penalty"
    lock: str = "instant"
    blend_width: float = 1.0e-3
    first_tangent: str = "last_rate"
    procedures: str = "internal"
    landing_tolerance: float = 1.0e-5

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z][a-z0-9_]{0,11}", self.name):
            raise SceneError(
                f"scene name '{self.name}': use a lower-case letter followed by at most 11 lower-case letters, digits or '_'"
            )
        for field, choices in _CHOICES.items():
            if getattr(self, field) not in choices:
                raise SceneError(f"{field} '{getattr(self, field)}' is not known; choose one of {', '.join(choices)}")
        if self.lock == "blend" and self.invariants == "printed":
            raise SceneError("lock 'blend' goes with invariants 'transverse' only; choose lock 'instant'")
        if not 1.0e-6 <= self.blend_width <= 0.02:
            raise SceneError(f"blend_width = {self.blend_width:g} must lie in [1e-6, 0.02] of logarithmic strain")
        if not 0.0 < self.landing_tolerance <= 1.0e-3:
            raise SceneError(
                f"landing_tolerance = {self.landing_tolerance:g} must lie in (0, 1e-3]: it is the error of the final width"
            )

    def as_dict(self) -> dict[str, object]:
        """The scene as plain data for the manifest."""
        return asdict(self)


_CHOICES: dict[str, tuple[str, ...]] = {
    "tangent": TANGENTS,
    "invariants": ("transverse", "printed"),
    "incompressibility": DEVICES,
    "lock": ("instant", "blend"),
    "procedures": ("internal", "external"),
    "first_tangent": ("last_rate", "floor"),
}

SCENES = {
    scene.name: scene
    for scene in (
        Scene(),
        Scene(name="paper", tangent="paper"),
        Scene(name="symmetric", tangent="symmetric"),
        Scene(name="printed", invariants="printed"),
        Scene(name="augmented", incompressibility="augmented"),
        Scene(name="blend", lock="blend"),
    )
}


def scene_by_name(name: str) -> Scene:
    """The shipped scene called `name`.

    Raises
    ------
    SceneError
        Lists the shipped scenes when there is none of that name.
    """
    if name not in SCENES:
        raise SceneError(f"scene '{name}' is not known; the shipped scenes are {', '.join(sorted(SCENES))}")
    return SCENES[name]
