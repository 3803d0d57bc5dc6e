"""Elastic constants: Table 4, stiffness ratios to 2.5e7, a thousand random admissible sets, inadmissible ones."""

from __future__ import annotations

import numpy as np

from plyflow.driver.drive import Step
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.rounding import Rounding, measure_rounding
from plyflow.evidence.stability.states import STAGES, random_increment, random_values
from plyflow.evidence.stability.subject import NOTHING, Column, Subject, Values
from plyflow.evidence.stability.tensors import Array
from plyflow.run.case_run import case_controls

SPOILED_BY_SIGN = ("w0", "h0", "l0_over_d", "k", "chi_ratio", "E_L", "E_T", "G_LT", "rate_floor")
SPOILED_BY_NO_NUMBER = ("k", "b_squeeze", "b_bleed", "E_L", "kappa")


def at_rest(check: Check, subject: Subject, column: Column) -> Outcome:
    """Stress and stiffness at F = I over a time in which the flow carries nothing."""
    values, worst = subject.values(column, kappa=0.0), 0.0
    wanted = _inverse_compliance(values)
    present = wanted != 0.0
    for locked in STAGES.values():
        answer = subject.call(np.eye(3), np.eye(3), 1e30, values, locked)
        if np.abs(answer.stress).max() > 1e-15 * wanted.max():
            return check.fail(f"F = I carries {np.abs(answer.stress).max():.3g} MPa")
        if np.abs(answer.ddsdde[~present]).max() > 1e-15 * wanted.max():
            return check.fail("a component of the stiffness that should vanish does not")
        worst = max(worst, float(np.abs(answer.ddsdde[present] / wanted[present] - 1.0).max()))
    return check.judge(worst)


def _inverse_compliance(values: Values) -> Array:
    along, across, nu, nu_t = (values[name] for name in ("E_L", "E_T", "nu_LT", "nu_TT"))
    root = np.sqrt(across / along)
    scaled = np.array([[1.0, -nu * root, -nu * root], [-nu * root, 1.0, -nu_t], [-nu * root, -nu_t, 1.0]])
    size = np.sqrt([along, across, across])
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = np.linalg.inv(scaled) * np.outer(size, size)
    stiffness[[3, 4, 5], [3, 4, 5]] = values["G_LT"], values["G_LT"], across / (2.0 * (1.0 + nu_t))
    return stiffness


def stiff(check: Check, subject: Subject, column: Column, ratio: float) -> Outcome:
    """Plate load on a ply whose fibre may stretch, Newton finding the fibre stress."""
    values = subject.values(column)
    values["E_L"] = values["E_T"] * ratio
    targets = {**NOTHING, "33": float(column.case().load_programme.pressure([1.0])[0])}
    steps = [
        Step(duration, targets, {"11": "S", "22": "S", "33": "P", "12": "F", "13": "F", "23": "F"})
        for duration in (1.0, 239.0)
    ]
    run = subject.drive(values, steps, case_controls()).ended()
    first, *later = (int(count) for count in run.history.iterations[1:])
    stretch = float(run.history.deformation_gradient[-1, 0, 0] - 1.0)
    return check.judge(max(later), iterations_from_rest=first, failed_increments=run.failed, fibre_stretch=stretch)


def random_roundings(subject: Subject) -> list[Rounding]:
    """One increment of each stage in turn for every random set of constants."""
    rng, found = subject.generator(1), []
    for number in range(200 if subject.quick else 1000):
        one = random_increment(random_values(subject, rng), number % 2 == 1, rng)
        found.append(measure_rounding(subject, *one))
    return found


def random_well_conditioned(check: Check, subject: Subject) -> Outcome:
    """Errors over the random sets of constants with a good condition."""
    roundings = subject.once(random_roundings)
    good = [one for one in roundings if one.well_conditioned]
    worst = max(good, key=lambda one: one.stress)
    return check.judge(worst.stress, sets=len(roundings), conditioned_below_1e3=len(good), condition=worst.condition)


def random_ill_conditioned(check: Check, subject: Subject) -> Outcome:
    """Errors over the other sets, against their condition."""
    roundings = subject.once(random_roundings)
    worst = max((one for one in roundings if not one.well_conditioned), key=lambda one: one.share)
    largest = max(one.condition for one in roundings)
    return check.judge(worst.share, error=worst.stress, condition=worst.condition, largest_condition=largest)


def inadmissible(check: Check, subject: Subject) -> Outcome:
    """Sets with one constant moved out of its bounds."""
    rng, message = subject.generator(2), ""
    for _ in range(100 if subject.quick else 500):
        values = random_values(subject, rng)
        values |= _spoiled(values, rng)
        answer = subject.call(np.eye(3), np.eye(3), 1.0, values)
        if not (answer.stopped and answer.messages):
            return check.fail(f"answered: {values}", 1.0)
        message = answer.messages
    return check.refuse(message, 0.0)


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
        *({name: -size} for name in SPOILED_BY_SIGN),
        *({name: float(rng.choice([np.nan, np.inf, -np.inf]))} for name in SPOILED_BY_NO_NUMBER),
    ]
    return choices[rng.integers(len(choices))]
