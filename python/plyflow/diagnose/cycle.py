"""Closed cycles of deformation: the work that a UMAT takes over one, from two step sizes."""

from __future__ import annotations

import numpy as np

from plyflow.diagnose.calls import Subject
from plyflow.driver.drive import Controls, Step, drive

LARGEST = 0.05  # of a component of F
STEPS = (40, 80)  # increments a side, for the error of the trapezoidal rule
SURE = 3.0
_SIDES = ("11", "12"), ("22", "33"), ("33", "23")


def created_energy(subject: Subject) -> tuple[float, float] | None:
    """Largest energy [MPa] that comes out of a square in two components of F, in either sense, and the largest work in it.

    0 where none does beyond the error of the sums; None where no cycle can be driven.
    """
    duration = sum(one.size for one in subject.increments) or 1.0
    amplitude = min(LARGEST, max(float(np.abs(one.end - np.eye(3)).max()) for one in subject.increments)) or LARGEST
    found = []
    for pair in _SIDES:
        for sides in (pair, pair[::-1]):
            for sign in (1.0, -1.0):
                works = [_work(subject, sides, sign * amplitude, duration, steps) for steps in STEPS]
                if all(work is not None for work in works):
                    found.append([work for work in works if work is not None])
    if not found:
        return None
    created = [
        (max(-fine - SURE * abs(fine - coarse) - 1e-9 * scale, 0.0), scale) for (coarse, _), (fine, scale) in found if scale > 0.0
    ]
    return max(created, key=lambda one: one[0] / one[1]) if created else (0.0, 1.0)


def _work(subject: Subject, sides: tuple[str, str], amplitude: float, duration: float, steps: int) -> tuple[float, float] | None:
    """Work over the square and the largest on the way, MPa."""
    first, second = sides
    far = {one: amplitude + (one[0] == one[1]) for one in sides}
    back = {one: float(one[0] == one[1]) for one in sides}
    targets = [{first: far[first]}, {second: far[second]}, {first: back[first]}, {second: back[second]}]
    size = duration / steps
    controls = Controls(initial_increment=size, minimum_increment=size, maximum_increment=size)
    n_statev = len(subject.increments[0].state)
    path = [Step(duration, target) for target in targets]
    history = drive(subject.library, subject.props, n_statev, path, controls, temperature=subject.temperature)
    return (float(history.work[-1]), float(np.abs(history.work).max())) if history.completed else None
