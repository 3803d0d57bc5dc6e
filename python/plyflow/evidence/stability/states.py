"""Deformations the checks start from, and random constants and increments a user could have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from plyflow.evidence.stability.subject import Subject, Values
from plyflow.evidence.stability.tensors import Array, compaction_stretch, limit_stretch, rotation

CLEAR_OF_LIMIT = 0.02
CLEAR_OF_LOCK = 1e-3
STAGES = {"squeeze": False, "bleed": True}


def compacted(eps: float) -> Array:
    """Isochoric compaction along axis 3, fibres straight, (3, 3)."""
    return np.diag([1.0, np.exp(-eps), np.exp(eps)])


def held_width(eps: float, values: Mapping[str, float]) -> Array:
    """Compaction along axis 3 at the locked width, (3, 3)."""
    return np.diag([1.0, np.exp(-values["eps_lock"]), np.exp(eps)])


def stage_increment(
    values: Mapping[str, float], locked: bool, size: float, fraction: float = 0.5
) -> tuple[Array, Array]:
    """One compaction increment of a stage: F0, F1.

    It ends at `fraction` of the way from no strain to the lock (squeeze) or from the lock to the limit
    (bleed) and has `size` of logarithmic strain.
    """
    lock, limit = values["eps_lock"], np.log(limit_stretch(values))
    if locked:
        eps = lock + fraction * (limit - lock)
        return held_width(eps + size, values), held_width(eps, values)
    return compacted(fraction * lock + size), compacted(fraction * lock)


class Increment(NamedTuple):
    """One increment, as `Subject.call` takes it: F0, F1 (3, 3), dt [s], PROPS by name, regime at the start."""

    start: Array
    end: Array
    dt: float
    values: Values
    locked: bool


def random_values(subject: Subject, rng: np.random.Generator) -> Values:
    """Random admissible PROPS: Table 2 and 3 columns moved about, any elasticity, geometry and floors."""
    column = subject.columns[rng.integers(len(subject.columns))]
    along = _log_uniform(rng, 1e-3, 1e5)
    across = along * _log_uniform(rng, 1e-9, 1.0)
    nu_across = rng.uniform(-0.4, 0.9)
    nu_bound = np.sqrt((1.0 - nu_across) * along / (2.0 * across))
    return subject.values(column) | {
        "w0": _log_uniform(rng, 1.0, 100.0),
        "h0": _log_uniform(rng, 0.05, 2.0),
        "l0_over_d": _log_uniform(rng, 1e2, 1e4),
        "k": rng.uniform(0.6, 0.98),
        "a": rng.uniform(-0.97, -0.1),
        "b_squeeze": rng.uniform(-20.0, -10.0),
        "b_bleed": rng.uniform(-36.0, -26.0),
        "eps_lock": -_log_uniform(rng, 5e-3, 0.4),
        "chi_ratio": rng.uniform(0.5, 0.9),
        "E_L": along,
        "E_T": across,
        "nu_LT": rng.uniform(-0.9, 0.9) * min(nu_bound, 0.5),
        "nu_TT": nu_across,
        "G_LT": across * _log_uniform(rng, 0.1, 10.0),
        "kappa": _log_uniform(rng, 1e-3, 1e3),
        "rate_floor": _log_uniform(rng, 1e-14, 1e-7),
        "strain_floor": _log_uniform(rng, 1e-14, 1e-10),
    }


def random_increment(values: Values, locked: bool, rng: np.random.Generator) -> Increment:
    """Increment of 1e-4 to 1e-1 of strain in any direction, clear of lock and limit, turned at will."""
    size, dt = _log_uniform(rng, 1e-4, 1e-1), _log_uniform(rng, 1e-10, 1e6)
    turn = rotation(0, rng.uniform(0, 360)) @ rotation(2, rng.uniform(0, 360))
    while True:
        end = _stretch(values, locked, rng)
        start = end - size * _direction(rng) @ end
        if admissible(start, values, locked) and admissible(end, values, locked):
            return Increment(turn @ start, turn @ end, dt, values, locked)


def _stretch(values: Values, locked: bool, rng: np.random.Generator) -> Array:
    """Transverse stretches about random axes, with some fibre stretch and fibre shear."""
    lock, limit = values["eps_lock"], np.log(limit_stretch(values))
    eps = rng.uniform(limit, lock) if locked else rng.uniform(lock, 0.02)
    turn = rotation(0, rng.uniform(0.0, 360.0))
    wide = np.exp((-lock if locked else -eps) + rng.uniform(-0.05, 0.05))
    gradient = turn @ np.diag([1.0 + rng.uniform(-0.05, 0.05), wide, np.exp(eps)]) @ turn.T
    gradient[1:, 0] = rng.uniform(-0.2, 0.2, size=2)
    return np.asarray(gradient)


def admissible(gradient: Array, values: Values, locked: bool) -> bool:
    """Whether a state lies in its stage, clear of lock and limit, with a positive volume."""
    stretch = float(compaction_stretch(gradient))
    eps, lock = np.log(stretch), values["eps_lock"]
    side = eps < lock - CLEAR_OF_LOCK if locked else eps > lock + CLEAR_OF_LOCK
    clear = stretch > limit_stretch(values) / (1.0 - CLEAR_OF_LIMIT)
    return bool(side and clear and np.linalg.det(gradient) > 0.0)


def _direction(rng: np.random.Generator) -> Array:
    direction = rng.normal(size=(3, 3))
    return np.asarray(direction / np.linalg.norm(direction))


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
