"""Every check of the matrix is shown once to fail on a planted error of the emitted source."""

from collections.abc import Iterator
from functools import cache
from types import ModuleType

import pytest

from planting import ERRORS
from plyflow.evidence.stability import (
    Bench,
    Verdict,
    constraint,
    cycles,
    elasticity,
    energy,
    invariants,
    iterations,
    limit,
    lock,
    matrix,
    objectivity,
    order,
    programmes,
    rates,
    refusals,
    rounding,
    shear,
)
from plyflow.evidence.stability.cells import Check, Task
from plyflow.evidence.stability.matrix import ACCOUNT, GROUPS, fill, run_matrix

SLOW = "a tangent three times too stiff"
ROUNDED = "a gap that loses its last digits"
UNLANDED = "no landing on the lock"
CASES: list[tuple[str, ModuleType, str]] = [
    ("no message", refusals, "end of the increment"),
    ("no message", refusals, "start of the increment"),
    ("no message", refusals, "dt = "),
    ("no message", refusals, "plane stress"),
    ("no message", refusals, "too few or too many"),
    ("state variables in the stress", refusals, "NaN in the state variables"),
    ("a stress that is not turned", rates, "no rate"),
    ("a rate exponent of zero or less", rates, "rate down to"),
    ("a rate exponent of zero or less", rates, "dt from 1e-10"),
    (ROUNDED, limit, "limit approached to"),
    ("no look at the limit", limit, "limit reached or overstepped"),
    ("no look at the limit", limit, "start beyond the limit"),
    ("no resistance at the limit", limit, "1000 MPa"),
    ("no look at the limit", limit, "plate driven through"),
    (UNLANDED, lock, "lock crossed in the middle"),
    ("a lock that never shuts", lock, "lock crossed at the end"),
    ("a lock ten times too wide", lock, "lock crossed by a tiny"),
    (UNLANDED, lock, "lock crossed by a huge"),
    ("a lock ten times too wide", lock, "lock crossed in steps"),
    ("a lock that opens again", lock, "back and forth over the lock, default"),
    ("a lock that opens again", lock, "back and forth over the lock, blend"),
    (UNLANDED, programmes, "ramp-dwell"),
    (UNLANDED, programmes, "monotonic"),
    (UNLANDED, programmes, "instant"),
    (SLOW, constraint, "kappa = "),
    ("a penalty a thousand times too soft", constraint, "kappa = 1e6"),
    ("a penalty a thousand times too soft", constraint, "short of the lock, kappa 1e4 times the load, penalty"),
    ("no pressure carried over", constraint, "short of the lock, kappa 1e4 times the load, augmented"),
    ("a viscous stress that drives", constraint, "short of the lock, kappa 1e4 times the load, multiplier"),
    ("volume not kept", constraint, "ramp-dwell programme"),
    ("volume not kept", constraint, "all columns"),
    ("a stress that is not turned", elasticity, "Table 4"),
    (SLOW, elasticity, "E_L/E_T"),
    (ROUNDED, elasticity, "random admissible"),
    (ROUNDED, elasticity, "the same where"),
    ("no check of the constants", elasticity, "random inadmissible"),
    ("a viscous stress that drives", shear, "simple shear"),
    (ROUNDED, shear, "simple shear 23"),
    (SLOW, shear, "shear stress"),
    (SLOW, shear, "fibre shortened"),
    (SLOW, shear, "fibre stress"),
    ("transverse springs", cycles, "unloaded"),
    ("transverse springs", cycles, "ten cycles"),
    ("transverse springs", cycles, "load taken off"),
    ("a viscous stress that drives", cycles, "plate moved"),
    ("a stress that is not turned", objectivity, "0 to 360"),
    ("no floor of the rate", objectivity, "rotation alone"),
    ("transverse form refused", invariants, "C = (1 + d) I"),
    ("transverse form refused", invariants, "random strains"),
    ("transverse form refused", invariants, "ramp-dwell"),
    (SLOW, iterations, "consistent"),
    (SLOW, iterations, "every case ends"),
    ("a stiff first tangent", iterations, "extrapolation none"),
    (SLOW, iterations, "extrapolation linear"),
    ("a tangent half a percent off", order, "consistent tangent"),
    ("dissipation a thousandth too high", energy, "stored + dissipated"),
    ("dissipation a thousandth too high", energy, "increments refined"),
    ("dissipation that falls", energy, "dissipation of every increment"),
    (ROUNDED, rounding, "increments of the ramp-dwell"),
    (ROUNDED, rounding, "random increments"),
]
FOR_COMPARISON = ("paper tangent: order", "symmetric tangent: order")
"""Rows that show what the other tangents do; their bound only asks that they converge at all."""


@cache
def planted_bench(plant: str) -> Bench:
    """Bench whose sources carry the error."""
    return Bench(quick=True, edit=ERRORS[plant])


def first_task(bench: Bench, group: ModuleType, part: str) -> Task:
    """First cell of a group whose check has this in its name."""
    tasks: Iterator[Task] = group.tasks(bench)
    return next(task for task in tasks if part in task.check.name)


@pytest.mark.parametrize(("plant", "group", "part"), CASES, ids=[f"{part}: {plant}" for plant, _, part in CASES])
def test_check_fails_on_a_planted_error(plant: str, group: ModuleType, part: str) -> None:
    """Without the error it holds: see the tests of the reduced matrix."""
    bench = planted_bench(plant)
    outcome = fill(bench, first_task(bench, group, part))
    assert outcome.verdict is Verdict.FAILS
    assert not outcome.reason.startswith("uncaught")


def test_no_check_of_the_matrix_is_left_out(bench: Bench) -> None:
    checks = {(group, task.check) for group in GROUPS for task in group.tasks(bench)}
    covered = [(group, part) for _, group, part in CASES]
    left_out = [
        check.name
        for group, check in checks
        if not any(group is other and part in check.name for other, part in covered)
        and not any(part in check.name for part in FOR_COMPARISON)
    ]
    assert not left_out


def account_of(plant: str, group: ModuleType, monkeypatch: pytest.MonkeyPatch) -> dict[Check, Verdict]:
    """Verdicts of the account after one group has run on a planted error."""
    monkeypatch.setattr(matrix, "GROUPS", (group,))
    cells = run_matrix(Bench(quick=True, edit=ERRORS[plant])).cells
    return {cell.check: cell.outcome.verdict for cell in cells if cell.check in ACCOUNT.values()}


@pytest.mark.parametrize(
    ("plant", "group", "kind"),
    [
        ("not a number", lock, "not finite"),
        ("a viscous stress that drives", rates, "wrong-sided"),
        ("no look at the limit", limit, "wrong-sided"),
        ("dissipation that falls", lock, "wrong-sided"),
    ],
)
def test_account_sees_what_no_cell_asked_for(
    monkeypatch: pytest.MonkeyPatch, plant: str, group: ModuleType, kind: str
) -> None:
    verdicts = account_of(plant, group, monkeypatch)
    assert verdicts[ACCOUNT[kind]] is Verdict.FAILS


def test_account_sees_a_refusal_without_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    """A call that asks for less without a word leaves the stress as it was: an answer of the wrong side."""
    verdicts = account_of("no message", refusals, monkeypatch)
    assert any(verdict is Verdict.FAILS for verdict in verdicts.values())


def test_account_sees_an_exception(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(_: Bench) -> list[Task]:
        return [Task(rates.NO_RATE, "all", lambda: rates.NO_RATE.judge(1.0 / len([])))]

    monkeypatch.setattr(rates, "tasks", broken)
    monkeypatch.setattr(matrix, "GROUPS", (rates,))
    finished = run_matrix(Bench(quick=True))
    verdicts = {cell.check: cell.outcome.verdict for cell in finished.cells}
    assert verdicts[rates.NO_RATE] is Verdict.FAILS
    assert verdicts[ACCOUNT["uncaught"]] is Verdict.FAILS
