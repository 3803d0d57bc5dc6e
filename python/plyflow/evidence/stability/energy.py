"""Energy: dissipation never falls, and what the loads put in is stored or dissipated.

The external work of a time-discrete history needs a path inside each increment. The backward difference of the law
says which: C goes from C0 to C1 along a straight line and the viscous stress is that of the end. Along this path the
viscous work S_v:(C1 - C0)/2 is exact, and the elastic part and the penalty are integrated by Gauss's rule from laws that
share nothing with the generated code. The usual sums, P:dF at the right end or by the trapezoidal rule, tend to the
same number as the increments shrink, at first order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case, driver_steps
from plyflow.driver.drive import Controls, History, Step
from plyflow.evidence.stability.bench import LOCKED, Bench, Column, Values
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.constraint import DEVICES
from plyflow.evidence.stability.cycles import sawtooth
from plyflow.evidence.stability.ledger import viscous_work
from plyflow.evidence.stability.tensors import Array, elastic_stress, green, second_piola
from plyflow.run.case_run import case_controls

GROUP = "Energy"
BALANCE = 1e-6
MEASURES = "|external work - SSE - dissipation - let go at the lock| / external work [-]"
BALANCED = {
    (load, device): Check(GROUP, f"{load}, {device}: stored + dissipated = external work", MEASURES, BALANCE)
    for load in ("ramp-dwell", "monotonic", "cyclic")
    for device in DEVICES
}
DISSIPATED = Check(
    GROUP, "dissipation of every increment of every history above", "least dissipation of an increment [MPa]", 0.0, True
)
REFINED = Check(
    GROUP,
    "increments refined 1 to 32 times: S:dE at the right end tends to stored + dissipated",
    "difference extrapolated to no increment, relative [-]",
    1e-4,
)
REFINEMENTS = (1, 2, 4, 8, 16, 32)
Runner = Callable[[Column, str, str], tuple[Values, History]]
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True)
class Account:
    """Energies of a history per reference volume, MPa; `released`: SSE of the penalty that ends at the lock."""

    work: float
    stored: float
    dissipated: float
    released: float

    @property
    def error(self) -> float:
        """What is missing, relative to the work."""
        return abs(self.work - self.stored - self.dissipated - self.released) / self.work


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    run = cache(partial(run_history, bench))
    for column in bench.columns:
        for how, check in BALANCED.items():
            yield Task(
                check,
                column.label,
                partial(balanced, check, run, column, *how),
            )
        yield Task(
            DISSIPATED,
            column.label,
            partial(dissipated, run, column),
        )
    for column in bench.few(bench.columns, 2):
        yield Task(REFINED, column.label, partial(refined, bench, column))


def run_history(
    bench: Bench, column: Column, load: str, device: str, refinement: float = 1.0
) -> tuple[Values, History]:
    """One whole history: PROPS and what the driver made of them."""
    case = Case(column.material, column.temperature, "BP", 15.0, "monotonic" if load == "monotonic" else "ramp-dwell")
    values = bench.values(column)
    steps: Sequence[Step] = driver_steps(case.load_programme)
    if load == "cyclic":
        steps = sawtooth(case.load_programme.peak)
    scene, extra = DEVICES[device]
    base = case_controls(refinement)
    controls = Controls(
        initial_increment=base.initial_increment, maximum_increment=base.maximum_increment, growth=base.growth, **extra
    )
    return values, bench.drive(values, steps, controls, scene)


def account(history: History, values: Values, augmented: bool = False) -> Account:
    """Work along the path of the backward difference, beside the UMAT's energies.

    augmented : the pressure at the start of each increment works on as a constant.
    """
    gradients, right = history.deformation_gradient, green(history.deformation_gradient)
    volume = np.linalg.det(gradients)[:, None, None]
    multiplier = history.pressure[:, None, None] * volume * np.linalg.inv(right)
    stress = second_piola(history.stress, gradients) - multiplier
    viscous, _ = viscous_work(stress[1:], gradients, history.statev[1:, 5], values)
    stage = history.statev[:-1, LOCKED] >= 0.5
    elastic = _path_work(right, values, stage)
    carried = np.where(stage, 0.0, -history.statev[:-1, 5]) if augmented else 0.0
    constraint = (history.pressure[1:] + carried) * np.diff(volume[:, 0, 0])
    locking = np.flatnonzero(np.diff(stage.astype(int)) > 0)
    released = sum(0.5 * values["kappa"] * (volume[index + 1, 0, 0] - 1.0) ** 2 for index in locking)
    return Account(
        work=float((viscous + elastic + constraint).sum()),
        stored=float(history.energies[-1, 0]),
        dissipated=float(history.energies[-1, 2]),
        released=float(released),
    )


def _path_work(right: Array, values: Values, locked: NDArray[np.bool_]) -> Array:
    """Work (n,) of elastic stress and penalty along straight lines between the C of a history, MPa."""
    strain, total = 0.5 * np.diff(right, axis=0), np.zeros(len(right) - 1)
    for point, weight in zip(POINTS, WEIGHTS, strict=True):
        between = right[:-1] + 0.5 * (1.0 + point) * np.diff(right, axis=0)
        volume = np.sqrt(np.linalg.det(between))[:, None, None]
        penalty = np.where(locked, 0.0, values["kappa"])[:, None, None] * (volume - 1.0) * volume
        stress = elastic_stress(between, values) + penalty * np.linalg.inv(between)
        total += 0.5 * weight * (stress * strain).sum(axis=(1, 2))
    return total


def balanced(check: Check, run: Runner, column: Column, load: str, device: str) -> Outcome:
    """Balance over one whole history."""
    values, history = run(column, load, device)
    if not history.completed:
        return check.refuse(history.message)
    found = account(history, values, augmented=device == "augmented")
    usual = {
        "P_dF_right": history.work_right[-1],
        "P_dF_trapezoidal": history.work[-1],
        "S_dE_right": right_work(history),
    }
    ends = found.stored + found.dissipated
    return check.judge(
        found.error,
        work_MPa=found.work,
        let_go_at_the_lock=found.released / found.work,
        **{f"beside_{name}": float(abs(value - ends) / ends) for name, value in usual.items()},
    )


def right_work(history: History) -> float:
    """Sum of S:(C1 - C0)/2 with the stress at the right end of each increment, MPa."""
    stress = second_piola(history.stress, history.deformation_gradient)
    strain = 0.5 * np.diff(green(history.deformation_gradient), axis=0)
    return float((stress[1:] * strain).sum())


def dissipated(run: Runner, column: Column) -> Outcome:
    """Least dissipation of an increment over the histories of this group."""
    histories = [run(column, *how)[1] for how in BALANCED]
    for history in histories:
        if not history.completed:
            return DISSIPATED.refuse(history.message)
    return DISSIPATED.judge(min(float(np.diff(history.energies[:, 2]).min()) for history in histories))


def refined(bench: Bench, column: Column) -> Outcome:
    """The plain sum S:dE beside the energies, with ever smaller increments, and where it tends to."""
    differences = []
    for refinement in REFINEMENTS:
        _, history = run_history(bench, column, "ramp-dwell", "multiplier", refinement)
        ends = float(history.energies[-1, [0, 2]].sum())
        differences.append((right_work(history) - ends) / ends)
    limit = 2.0 * differences[-1] - differences[-2]
    order = float(np.log2(abs(differences[-2] / differences[-1])))
    return REFINED.judge(
        abs(limit), order=order, **{f"at_refinement_{n}": d for n, d in zip(REFINEMENTS, differences, strict=False)}
    )
