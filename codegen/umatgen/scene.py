"""A scene: what the generated UMAT keeps. Frozen and validated; everything not kept is left out of the source."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass

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
    landing_tolerance : half width in logarithmic strain of the band around eps_lock that counts as the lock.

    Raises
    ------
    SceneError
        Names the field, the value, what is allowed.
    """

    name: str = "default"
    tangent: str = "consistent"
    landing_tolerance: float = 1.0e-5

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z][a-z0-9_]{0,11}", self.name):
            raise SceneError(
                f"scene name '{self.name}': use a lower-case letter followed by at most 11 lower-case letters, digits or '_'"
            )
        if self.tangent not in TANGENTS:
            raise SceneError(f"tangent '{self.tangent}' is not known; choose one of {', '.join(TANGENTS)}")
        if not 0.0 < self.landing_tolerance <= 1.0e-3:
            raise SceneError(
                f"landing_tolerance = {self.landing_tolerance:g} must lie in (0, 1e-3]: it is the error of the final width"
            )

    def as_dict(self) -> dict[str, object]:
        """The scene as plain data for the manifest."""
        return asdict(self)


SCENES = {
    scene.name: scene
    for scene in (
        Scene(),
        Scene(name="paper", tangent="paper"),
        Scene(name="symmetric", tangent="symmetric"),
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
