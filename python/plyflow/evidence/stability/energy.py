"""Energy: dissipation never falls, and what the loads put in is stored or dissipated.

The external work of a time-discrete history needs a path inside each increment. The backward difference of the law (scene
bdf1) says which: C goes from C0 to C1 along a straight line and the viscous stress is that of the end. Along this path the
viscous work S_v:(C1 - C0)/2 is exact, and the elastic part and the penalty are integrated by Gauss's rule from laws that
share nothing with the generated code. The usual sums, P:dF at the right end or by the trapezoidal rule, tend to the
same number as the increments shrink, at first order.

The creep-exact scene counts the work of its mean stress on the logarithmic strain. Beside it stands the plate's work with
the mean of the load over each increment, which agrees to second order, and the integral of p d|eps| of the
one-dimensional law.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from plyflow.case.case import driver_steps, law_parameters
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.constraint import DEVICES
from plyflow.evidence.stability.ledger import multiplier_stress, rate_starts, viscous_stress, viscous_work
from plyflow.evidence.stability.lock import cycle_steps
from plyflow.evidence.stability.subject import Column, Run, Subject, Values
from plyflow.evidence.stability.tensors import Array, elastic_stress, green, second_piola
from plyflow.law import LoadProgramme, integrate
from plyflow.run.case_run import case_controls

LOADS = ("ramp-dwell", "monotonic", "cyclic")
BACKWARD = {"default": "bdf1", "augmented": "bdf1 augmented"}
"""Scenes of the devices with the backward difference."""
REFINEMENTS = (1, 2, 4, 8, 16, 32)
MEAN_REFINEMENTS = (8, 32)
LAW_SHARES = np.linspace(0.0, 1.0, 2001) ** 2
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True)
class Account:
    """Energies of a history per reference volume, MPa.

    `released`: SSE of the penalty that ends at the lock, and the work of the viscous stress in the increment that locks
    over the widening up to the lock, which its rate leaves out.
    """

    work: float
    stored: float
    dissipated: float
    released: float

    @property
    def error(self) -> float:
        """What is missing, relative to the work."""
        return abs(self.work - self.stored - self.dissipated - self.released) / self.work


def run_history(
    subject: Subject, column: Column, load: str, device: str, integrator: str = "bdf1", refinement: float = 1.0
) -> Run:
    """One whole history; both integrators with the increments of "bdf1"."""
    programme = column.case(load="monotonic" if load == "monotonic" else "ramp-dwell").load_programme
    steps = cycle_steps("cycles", programme.peak) if load == "cyclic" else driver_steps(programme)
    scene, extra = DEVICES[device]
    scene = BACKWARD[scene] if integrator == "bdf1" else scene
    return subject.drive(subject.values(column), steps, replace(case_controls(refinement), **extra), scene)


def account(run: Run, augmented: bool = False) -> Account:
    """Work along the path of the backward difference, beside the UMAT's energies.

    augmented : the pressure at the start of each increment works on as a constant.
    """
    history, gradients, kappa = run.history, run.history.deformation_gradient, run.values["kappa"]
    volume = np.linalg.det(gradients)
    stress = second_piola(history.stress, gradients) - multiplier_stress(history)
    viscous, _ = viscous_work(stress[1:], gradients, history.statev, run.values)
    flow = viscous_stress(stress[1:], gradients[1:], history.statev[1:, 5], run.values)
    widened = rate_starts(gradients, history.statev, run.values) - green(gradients[:-1])
    let_go = 0.5 * (flow * widened).sum(axis=(1, 2))
    stage = run.locked[1:] >= 0.5
    elastic = _path_work(green(gradients), run.values, np.where(stage, 0.0, kappa))
    carried = np.where(stage, 0.0, -history.statev[:-1, 5]) if augmented else 0.0
    constraint = (history.pressure[1:] + carried) * np.diff(volume)
    locking = np.flatnonzero(np.diff(run.locked) > 0.0)
    return Account(
        work=float((viscous + let_go + elastic + constraint).sum()),
        stored=float(history.energies[-1, 0]),
        dissipated=float(history.energies[-1, 2]),
        released=float(let_go.sum() + sum(0.5 * kappa * (volume[index] - 1.0) ** 2 for index in locking)),
    )


def _path_work(right: Array, values: Values, kappa: Array) -> Array:
    """Work (n,) of elastic stress and penalty along straight lines between the C of a history, MPa."""
    strain, total = 0.5 * np.diff(right, axis=0), np.zeros(len(right) - 1)
    for point, weight in zip(POINTS, WEIGHTS, strict=True):
        between = right[:-1] + 0.5 * (1.0 + point) * np.diff(right, axis=0)
        volume = np.sqrt(np.linalg.det(between))[:, None, None]
        penalty = kappa[:, None, None] * (volume - 1.0) * volume
        stress = elastic_stress(between, values) + penalty * np.linalg.inv(between)
        total += 0.5 * weight * (stress * strain).sum(axis=(1, 2))
    return total


def right_work(run: Run) -> float:
    """Sum of S:(C1 - C0)/2 with the stress at the right end of each increment, MPa."""
    gradients = run.history.deformation_gradient
    return float((second_piola(run.history.stress, gradients)[1:] * (0.5 * np.diff(green(gradients), axis=0))).sum())


def balanced(check: Check, subject: Subject, column: Column, load: str, device: str) -> Outcome:
    """Balance over one whole history."""
    run = subject.once(run_history, column, load, device).ended()
    found = account(run, augmented=device == "augmented")
    usual = {
        "P_dF_right": run.history.work_right[-1],
        "P_dF_trapezoidal": run.history.work[-1],
        "S_dE_right": right_work(run),
    }
    ends = found.stored + found.dissipated
    return check.judge(
        found.error,
        work_MPa=found.work,
        let_go_at_the_lock=found.released / found.work,
        **{f"beside_{name}": float(abs(value - ends) / ends) for name, value in usual.items()},
    )


def dissipated(check: Check, subject: Subject, column: Column) -> Outcome:
    """Least dissipation of an increment over the histories of this group."""
    runs = [
        subject.once(run_history, column, load, device, integrator).ended()
        for load, device, integrator in product(LOADS, DEVICES, ("bdf1", "creep"))
    ]
    return check.judge(min(float(np.diff(run.history.energies[:, 2]).min()) for run in runs))


def refined(check: Check, subject: Subject, column: Column) -> Outcome:
    """The plain sum S:dE beside the energies, with ever smaller increments, and where it tends to."""
    found = {}
    for refinement in REFINEMENTS:
        run = run_history(subject, column, "ramp-dwell", "multiplier", refinement=refinement)
        ends = float(run.history.energies[-1, [0, 2]].sum())
        found[f"at_refinement_{refinement}"] = (right_work(run) - ends) / ends
    before, last = list(found.values())[-2:]
    return check.judge(abs(2.0 * last - before), order=float(np.log2(abs(before / last))), **found)


def mean_work(run: Run) -> float:
    """Plate's work with the mean of the load over each increment, MPa; volume at its end, as the UMAT counts it."""
    history = run.history
    volume, strain = np.linalg.det(history.deformation_gradient), np.log(history.deformation_gradient[:, 2, 2])
    load = -0.5 * (history.stress[1:, 2] + history.stress[:-1, 2])
    return float(-(load * volume[1:] * np.diff(strain)).sum())


def law_work(run: Run, programme: LoadProgramme) -> float:
    """Integral of p d|eps| of the one-dimensional law per reference volume, MPa: the volume falls after the lock."""
    law = law_parameters(run.values)
    parts = [start + (end - start) * LAW_SHARES for start, end, *_ in programme.pieces()]
    history = integrate(law, programme, np.unique(np.concatenate(parts)))
    load = history.pressure * np.minimum(1.0, np.exp(history.eps - law.eps_lock))
    return float(-np.trapezoid(load, history.eps))


def meant(check: Check, subject: Subject, column: Column, load: str) -> Outcome:
    """Order at which the work of the mean load and what is stored and dissipated come together."""
    found = []
    for refinement in MEAN_REFINEMENTS:
        run = run_history(subject, column, load, "penalty", "creep", refinement).ended()
        work = mean_work(run)
        found.append(abs(1.0 - float(run.history.energies[-1, [0, 2]].sum()) / work))
    order = np.log(found[0] / found[1]) / np.log(MEAN_REFINEMENTS[1] / MEAN_REFINEMENTS[0])
    names = (f"at_refinement_{refinement}" for refinement in MEAN_REFINEMENTS)
    return check.judge(float(order), **dict(zip(names, found, strict=True)))


def lawful(check: Check, subject: Subject, column: Column, load: str, refinement: float) -> Outcome:
    """Dissipation of the creep-exact scene beside that of the law; also with its own, coarsest increments."""
    programme = column.case(load=load).load_programme
    run = run_history(subject, column, load, "penalty", "creep", refinement).ended()
    wanted = law_work(run, programme)
    own = subject.drive(run.values, driver_steps(programme), case_controls(integrator="creep")).ended()
    errors = [abs(float(one.history.energies[-1, 2]) / wanted - 1.0) for one in (run, own)]
    counts = [one.history.increments for one in (run, own)]
    return check.judge(
        errors[0], increments=counts[0], with_its_own_increments=errors[1], its_own_increments=counts[1]
    )
