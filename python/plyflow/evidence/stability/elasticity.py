"""Elastic constants: Table 4, stiffness ratios to 2.5e7, a thousand random admissible sets, inadmissible ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial

import numpy as np

from plyflow.case.case import Case
from plyflow.driver.drive import Kind, Step
from plyflow.evidence.stability.bench import Bench, Column, Values
from plyflow.evidence.stability.cells import WHOLE, Check, Outcome, Task
from plyflow.evidence.stability.precision import WELL_CONDITIONED, Rounding, measure_rounding
from plyflow.evidence.stability.programmes import failed_increments
from plyflow.evidence.stability.states import STAGES, random_increment, random_values
from plyflow.evidence.stability.tensors import Array
from plyflow.run.case_run import case_controls

GROUP = "Elastic constants"
AT_REST = Check(
    GROUP,
    "Table 4: F = I stress free, stiffness at rest the inverse of the compliance",
    "largest error of a component of the stiffness, relative [-]",
    1e-12,
)
RATIOS = (1.0, 1e2, 1e4, 1e6, 2.5e7)
STIFF = {
    ratio: Check(
        GROUP,
        f"E_L/E_T = {ratio:g}, fibre free to stretch, plate load: ends",
        "worst number of iterations of an increment",
        12,
    )
    for ratio in RATIOS
}
RANDOM = Check(
    GROUP,
    "random admissible constants: finite, right side, exact where conditioned better than 1e3",
    "largest error of the stress where the condition is below 1e3, relative [-]",
    1e-12,
)
RANDOM_ILL = Check(
    GROUP,
    "the same where the condition is above 1e3: as exact as the input",
    "error against quadruple precision / (condition x rounding) [-]",
    4.0,
)
INADMISSIBLE = Check(
    GROUP, "random inadmissible constants: refused with a message", "sets answered", 0.0, may_refuse=True
)
FREE_KINDS: dict[str, Kind] = {"11": "S", "22": "S", "33": "P", "12": "F", "13": "F", "23": "F"}


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for column in bench.columns:
        yield Task(AT_REST, column.label, partial(at_rest, bench, column))
        for ratio, check in STIFF.items():
            yield Task(check, column.label, partial(stiff, bench, column, ratio))
    roundings = cache(partial(_random_roundings, bench))
    for check in (RANDOM, RANDOM_ILL):
        yield Task(check, WHOLE, partial(random_admissible, roundings, check))
    yield Task(INADMISSIBLE, WHOLE, partial(inadmissible, bench))


def at_rest(bench: Bench, column: Column) -> Outcome:
    """Stress and stiffness at F = I over a time in which the flow carries nothing."""
    values, worst = bench.values(column, kappa=0.0), 0.0
    wanted = _inverse_compliance(values)
    for locked in STAGES.values():
        answer = bench.call(np.eye(3), np.eye(3), 1e30, values, locked)
        if np.abs(answer.stress).max() > 1e-15 * wanted.max():
            return AT_REST.fail(f"F = I carries {np.abs(answer.stress).max():.3g} MPa")
        present = wanted != 0.0
        if np.abs(answer.ddsdde[~present]).max() > 1e-15 * wanted.max():
            return AT_REST.fail("a component of the stiffness that should vanish does not")
        worst = max(worst, float(np.abs(answer.ddsdde[present] / wanted[present] - 1.0).max()))
    return AT_REST.judge(worst)


def _inverse_compliance(values: Values) -> Array:
    along, across, nu, nu_t = (values[name] for name in ("E_L", "E_T", "nu_LT", "nu_TT"))
    root = np.sqrt(across / along)
    scaled = np.array([[1.0, -nu * root, -nu * root], [-nu * root, 1.0, -nu_t], [-nu * root, -nu_t, 1.0]])
    size = np.sqrt([along, across, across])
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = np.linalg.inv(scaled) * np.outer(size, size)
    stiffness[[3, 4, 5], [3, 4, 5]] = values["G_LT"], values["G_LT"], across / (2.0 * (1.0 + nu_t))
    return stiffness


def stiff(bench: Bench, column: Column, ratio: float) -> Outcome:
    """Plate load on a ply whose fibre may stretch, Newton finding the fibre stress."""
    check, case = STIFF[ratio], Case(column.material, column.temperature, "BP", 15.0)
    values = bench.values(column)
    values |= {"E_L": values["E_T"] * ratio}
    load = case.load_programme.pressure([1.0])[0]
    targets = {"11": 0.0, "22": 0.0, "33": float(load), "12": 0.0, "13": 0.0, "23": 0.0}
    steps = [Step(duration, targets, FREE_KINDS) for duration in (1.0, 239.0)]
    history = bench.drive(values, steps, case_controls())
    if not history.completed:
        return check.refuse(history.message)
    return check.judge(
        int(history.iterations[1:].max()),
        failed_increments=failed_increments(history),
        fibre_stretch=float(history.deformation_gradient[-1, 0, 0] - 1.0),
    )


def random_admissible(measure: Callable[[], list[Rounding]], check: Check) -> Outcome:
    """Judge the increments of all random sets of constants, well or ill conditioned."""
    roundings = measure()
    good = [one for one in roundings if one.condition < WELL_CONDITIONED]
    if check is RANDOM:
        worst = max(good, key=lambda one: one.stress)
        return check.judge(
            worst.stress, sets=len(roundings), conditioned_below_1e3=len(good), condition=worst.condition
        )
    worst = max((one for one in roundings if one.condition >= WELL_CONDITIONED), key=lambda one: one.share)
    return check.judge(
        worst.share,
        error=worst.stress,
        condition=worst.condition,
        largest_condition=max(one.condition for one in roundings),
    )


def _random_roundings(bench: Bench) -> list[Rounding]:
    """One increment of each stage in turn for every random set of constants."""
    rng, found = bench.generator(1), []
    for number in range(200 if bench.quick else 1000):
        one = random_increment(random_values(bench, rng), number % 2 == 1, rng)
        found.append(measure_rounding(bench, (one.start, one.end), one.dt, one.values, one.locked))
    return found


def inadmissible(bench: Bench) -> Outcome:
    """Sets with one constant moved out of its bounds."""
    rng, message = bench.generator(2), ""
    for _ in range(100 if bench.quick else 500):
        values = random_values(bench, rng)
        values |= _spoiled(values, rng)
        answer = bench.call(np.eye(3), np.eye(3), 1.0, values)
        if not (answer.stopped and answer.messages):
            return INADMISSIBLE.fail(f"answered: {values}", 1.0)
        message = answer.messages
    return INADMISSIBLE.refuse(message, 0.0)


def _spoiled(values: Values, rng: np.random.Generator) -> Values:
    bound = np.sqrt((1.0 - values["nu_TT"]) * values["E_L"] / (2.0 * values["E_T"]))
    size = 10.0 ** rng.uniform(-6, 3)
    choices = [
        {"nu_LT": float(bound * (1.0 + size))},
        {"nu_TT": 1.0 + size},
        {"nu_TT": -1.0 - size},
        {"a": -1.0 - size},
        {"a": size},
        {"eps_lock": size},
        {"kappa": -size},
        *({name: -size} for name in ("w0", "h0", "l0_over_d", "k", "chi_ratio", "E_L", "E_T", "G_LT", "rate_floor")),
        *(
            {name: float(rng.choice([np.nan, np.inf, -np.inf]))}
            for name in ("k", "b_squeeze", "b_bleed", "E_L", "kappa")
        ),
    ]
    return choices[rng.integers(len(choices))]
