"""Random admissible increments in doubles: seeded, clear of the lock and above the compaction limit."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from mpmath import mp
from numpy.typing import NDArray

from oracle.algebra import contract, right_cauchy_green, scale, subtract, tensor
from oracle.elastic import elastic_stress, penalty_stress
from oracle.paper_tables import IM7_8552, ROWS, TABLE_4
from oracle.properties import PROPERTY_NAMES, Properties
from oracle.viscous import viscous_stress

Array = NDArray[np.float64]
GAP_TO_LIMIT = 0.02
"""Least (sqrt(x) - k/sqrt(chi_f)) / sqrt(x) at both ends of the increment."""
GAP_TO_LOCK = 1.0e-3
"""Least distance of the compaction strain from the lock at both ends: the regime is never in doubt."""
PARTS = {"balanced": (0.3, 3.0), "mostly viscous": (1.0e-3, 1.0e-2)}
"""Bounds of the elastic part and of the penalty relative to the viscous part, where they are scaled to it."""
ELASTICITIES = ("table 4", "balanced", "moderate", "mostly viscous")
ELASTIC_SLICE = slice(PROPERTY_NAMES.index("E_L"), PROPERTY_NAMES.index("G_LT") + 1)
STIFFNESSES = [PROPERTY_NAMES.index(name) for name in ("E_L", "E_T", "G_LT")]
KAPPA = PROPERTY_NAMES.index("kappa")
STRAIN_FLOOR = PROPERTY_NAMES.index("strain_floor")


@dataclass(frozen=True, eq=False)
class State:
    """One increment: F0 and F1 (3, 3), dt in s, the 17 PROPS, the regime, and how it was drawn."""

    start: Array
    end: Array
    time_increment: float
    props: Array
    locked: bool
    strain_increment: float
    label: str


def random_states(
    seed: int,
    count: int,
    locked: bool,
    increments: tuple[float, float] = (1.0e-3, 1.0e-1),
    *,
    times: tuple[float, float] = (1.0e-6, 1.0e3),
    relative_rotation: bool | None = None,
) -> list[State]:
    """Draw ``count`` increments of one regime.

    Parameters
    ----------
    seed, count, locked
        Of the generator; how many; bleeding flow if true.
    increments
        Bounds of the strain increment, log-uniform.
    times
        Bounds of dt in s, log-uniform.
    relative_rotation
        Ends turned independently by up to 180 degrees (true), together (false), or either in turn (none).
    """
    rng = np.random.default_rng(seed)
    turns = (i // 4 % 2 == 1 if relative_rotation is None else relative_rotation for i in range(count))
    return [_draw(rng, locked, increments, times, _Kind(_cycled(i), turned)) for i, turned in enumerate(turns)]


def random_rotation(rng: np.random.Generator) -> Array:
    """Turn about a random axis by an angle uniform in 0 to 180 degrees."""
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle = rng.uniform(0.0, np.pi)
    turned: Array = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)
    return turned


def _log_uniform(rng: np.random.Generator, bounds: tuple[float, float]) -> float:
    return float(np.exp(rng.uniform(*np.log(bounds))))


class _Kind(NamedTuple):
    elasticity: str
    turned: bool


def _cycled(index: int) -> str:
    return ELASTICITIES[index % len(ELASTICITIES)]


def _draw(
    rng: np.random.Generator, locked: bool, increments: tuple[float, float], times: tuple[float, float], kind: _Kind
) -> State:
    elasticity, turned = kind
    size = _log_uniform(rng, increments)
    props = _properties(rng, elasticity, size)
    start, end = next(_ends(rng, props, locked, size))
    first = random_rotation(rng)
    second = random_rotation(rng) if turned else first
    label = f"{elasticity}, {'independent' if turned else 'common'} rotations, strain {size:.1e}"
    state = State(first @ start, second @ end, _log_uniform(rng, times), props, locked, size, label)
    return _scaled(rng, state, PARTS[elasticity]) if elasticity in PARTS else state


def _properties(rng: np.random.Generator, elasticity: str, size: float) -> Array:
    k, a, b_squeeze, b_bleed = ROWS[rng.integers(len(ROWS))]
    elastic = TABLE_4
    kappa = _log_uniform(rng, (1.0e-1, 1.0e2))
    if elasticity != "table 4":
        along, across = _log_uniform(rng, (1.0, 1.0e3)), _log_uniform(rng, (1.0e-2, 1.0))
        ratios = (rng.uniform(0.05, 0.35), rng.uniform(0.1, 0.5))
        elastic = (along, across, *ratios, across * rng.uniform(0.3, 3.0))
    strain_floor = size * rng.uniform(0.1, 2.0) if rng.random() < 0.2 else _log_uniform(rng, (1e-14, 1e-10))
    geometry = (_log_uniform(rng, (5.0, 40.0)), _log_uniform(rng, (0.1, 1.0)), rng.uniform(1.0e3, 6.0e3))
    lock = (rng.uniform(-0.35, -0.05), rng.uniform(0.6, 0.8))
    floors = (_log_uniform(rng, (1e-13, 1e-7)), strain_floor)
    return np.array([*geometry, k, a, b_squeeze, b_bleed, *lock, *elastic, kappa, *floors])


def _limit(props: Array) -> float:
    """Compaction limit as a Hencky strain, ln(k/sqrt(chi_f))."""
    named = dict(zip(PROPERTY_NAMES, props, strict=True))
    return float(np.log(named["k"]) + named["eps_lock"] + 0.5 * np.log(named["chi_ratio"]))


def _admissible(deformation: Array, props: Array, locked: bool) -> bool:
    lock, limit = props[PROPERTY_NAMES.index("eps_lock")], _limit(props)
    eps = -0.5 * np.log(np.linalg.inv(deformation.T @ deformation)[2, 2])
    side = eps < lock - GAP_TO_LOCK if locked else eps > lock + GAP_TO_LOCK
    return bool(side and 1.0 - np.exp(limit - eps) > GAP_TO_LIMIT and np.linalg.det(deformation) > 0)


def _ends(rng: np.random.Generator, props: Array, locked: bool, size: float) -> Iterator[tuple[Array, Array]]:
    """Admissible stretches at the end, and starts a strain of ``size`` away from them (with some spin)."""
    lock, limit = float(props[PROPERTY_NAMES.index("eps_lock")]), _limit(props)
    while True:
        eps = rng.uniform(limit, lock) if locked else rng.uniform(lock, 0.02)
        end = _stretch(rng, eps, -lock if locked else -eps)
        direction = rng.normal(size=(3, 3))
        start = end - size / np.linalg.norm(direction) * direction @ end
        if all(_admissible(f, props, locked) for f in (start, end)):
            yield start, end


def _stretch(rng: np.random.Generator, eps: float, log_width: float) -> Array:
    """Symmetric stretch with the given transverse strains in random axes, fibre stretch and fibre shears."""
    angle = rng.uniform(0.0, np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    log_wide = max(log_width + rng.uniform(-0.05, 0.05), eps + 0.01)
    green = np.zeros((3, 3))
    green[1:, 1:] = turn @ np.diag(np.exp([2 * eps, 2 * log_wide])) @ turn.T
    green[0, 0] = (1.0 + rng.choice([-1.0, 1.0]) * _log_uniform(rng, (5e-3, 5e-2))) ** 2
    green[0, 1:] = green[1:, 0] = rng.uniform(-0.2, 0.2, size=2)
    values, vectors = np.linalg.eigh(green)
    return np.asarray((vectors * np.sqrt(values)) @ vectors.T)


def _scaled(rng: np.random.Generator, state: State, bounds: tuple[float, float]) -> State:
    """Scale the moduli and the penalty so that their stresses are within bounds of the viscous stress."""
    with mp.workdps(20):
        p, time = Properties.of(state.props), mp.mpf(state.time_increment)
        c0, c1 = (right_cauchy_green(tensor(f)) for f in (state.start, state.end))
        rate = scale(1 / time, subtract(c1, c0))
        flow = viscous_stress(c1, rate, time, p, state.locked)
        parts = (flow, elastic_stress(c1, p), penalty_stress(c1, p))
        viscous, elastic, penalty = (float(mp.sqrt(contract(part, part))) for part in parts)
    props = state.props.copy()
    props[STIFFNESSES] *= viscous / elastic * _log_uniform(rng, bounds)
    props[KAPPA] *= viscous / penalty * _log_uniform(rng, bounds)
    return replace(state, props=props)


def properties_of(**changes: float) -> Array:
    """PROPS of IM7-8552 at 70 degC, 15 mm by 0.5 mm, Table 4, with what is given replaced, (17,)."""
    k, a, b_squeeze, b_bleed = IM7_8552[4]
    values = dict(zip(PROPERTY_NAMES, (15.0, 0.5, 4294.0, k, a, b_squeeze, b_bleed), strict=False))
    values |= {"eps_lock": -0.0593, "chi_ratio": 0.7}
    values |= dict(zip(PROPERTY_NAMES[ELASTIC_SLICE], TABLE_4, strict=True))
    values |= {"kappa": 1.0e3, "rate_floor": 1.0e-12, "strain_floor": 1.0e-12}
    unknown = set(changes) - set(values)
    assert not unknown, f"no such properties: {unknown}"
    return np.array([(values | changes)[name] for name in PROPERTY_NAMES])


def crossing_states(seed: int, count: int) -> list[State]:
    """Increments that start squeezing, up to 0.04 of strain before the lock, and end behind it."""
    rng = np.random.default_rng(seed)
    found = []
    for state in random_states(seed, count, locked=True):
        lock = state.props[PROPERTY_NAMES.index("eps_lock")]
        end = -0.5 * np.log(np.linalg.inv(state.end.T @ state.end)[2, 2])
        ratio = np.exp(lock + rng.uniform(GAP_TO_LOCK, 0.04) - end)
        start = state.end @ np.diag([1.0, 1.0 / ratio, ratio])
        found.append(replace(state, start=start, locked=False, label=f"across the lock, {state.label}"))
    return found
