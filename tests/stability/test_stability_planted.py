"""Every check of the matrix is shown once to fail on a planted error of the emitted source."""

from functools import cache

import pytest

from planting import ERRORS
from plyflow.evidence.stability.cells import Task, Verdict
from plyflow.evidence.stability.matrix import ACCOUNT, TABLE, all_tasks, fill, run_matrix
from plyflow.evidence.stability.subject import Subject

SLOW = "a tangent three times too stiff"
ROUNDED = "a gap that loses its last digits"
UNWIDENED = "no widening at the lock"
SEEN: dict[str, dict[str, list[str]]] = {
    "Input": {
        "no message": ["end of the increment", "start of the increment", "dt = ", "plane stress", "too few or too many"],
        "state variables in the stress": ["NaN in the state variables"],
    },
    "Rates": {
        "a stress that is not turned": ["no rate", "dt = 0, default"],
        "a rate lost without time": ["dt = 0, bdf1"],
        "a rate exponent of zero or less": ["rate down to", "dt from 1e-10"],
    },
    "Compaction limit": {
        ROUNDED: ["limit approached to"],
        "no look at the limit": ["limit reached or overstepped", "start beyond the limit", "plate driven through"],
        "no resistance at the limit": ["1000 MPa"],
    },
    "The lock": {
        UNWIDENED: ["increments of 1 s, default"],
        "widening from the end": ["increments of 0.03 s"],
        "stage by the start": ["increments of 1 s, bdf1", "lock crossed in steps of 1e-7, bdf1"],
        "a lock that never shuts": ["increments of 0.001 s", "lock crossed in steps of 1e-7, default"],
        "a lock that opens again": ["back and forth over the lock, default", "back and forth over the lock, bdf1"],
    },
    "Programmes": {
        UNWIDENED: ["ramp-dwell", "monotonic", "instant"],
    },
    "Incompressibility": {
        SLOW: ["kappa = "],
        "a penalty a thousand times too soft": ["kappa = 1e6", "short of the lock, kappa 1e4 times the load, penalty"],
        "no pressure carried over": ["short of the lock, kappa 1e4 times the load, augmented"],
        "a viscous stress that drives": ["short of the lock, kappa 1e4 times the load, multiplier"],
        "volume not kept": ["ramp-dwell programme", "all columns"],
    },
    "Elastic": {
        "a stress that is not turned": ["Table 4"],
        SLOW: ["E_L/E_T"],
        ROUNDED: ["random admissible", "the same where"],
        "no check of the constants": ["random inadmissible"],
    },
    "Shear": {
        "a viscous stress that drives": ["simple shear"],
        ROUNDED: ["simple shear 32"],
        SLOW: ["shear stress", "fibre shortened", "fibre stress"],
    },
    "Unloading": {
        "transverse springs": ["unloaded", "ten cycles", "load taken off"],
        "a viscous stress that drives": ["plate moved"],
    },
    "Superposed": {
        "a stress that is not turned": ["0 to 360"],
        "no floor of the rate": ["rotation alone"],
    },
    "Printed": {
        "transverse form refused": ["C = (1 + d) I", "random strains", "ramp-dwell"],
    },
    "Three tangents": {
        SLOW: ["consistent", "every case ends"],
    },
    "First iterations": {
        "a stiff first tangent": ["extrapolation none"],
        SLOW: ["extrapolation linear"],
    },
    "Order": {
        "a tangent half a percent off": ["consistent tangent"],
    },
    "Energy": {
        "dissipation a thousandth too high": [
            "stored + dissipated = external work", "tends to stored + dissipated", "increments of the backward difference"
        ],
        "dissipation two percent too high": ["integral of p d|eps|"],
        "dissipation that falls": ["dissipation of every increment"],
    },
    "Double": {
        ROUNDED: ["increments of the ramp-dwell", "random increments"],
    },
    "Many points": {
        UNWIDENED: ["seed 1, bdf1", "seed 1, default"],
        "a viscous stress that drives": ["in series, k and h0 +-5 %, bdf1", "in series, k and h0 +-5 %, default"],
    },
}
"""Errors by group (beginning of its title), and the checks (part of their names) that must see them."""
CASES = [(error, group, part) for group, seen in SEEN.items() for error, parts in seen.items() for part in parts]
FOR_COMPARISON = ("paper tangent: order", "symmetric tangent: order")
"""Rows that show what the other tangents do; their bound only asks that they converge at all."""


@cache
def planted_subject(error: str) -> Subject:
    """Subject whose sources carry the error."""
    return Subject(quick=True, edit=ERRORS[error])


def tasks_of(subject: Subject, group: str) -> list[Task]:
    """Cells of a group, by the beginning of its title."""
    return all_tasks(subject, [family["title"] for family in TABLE["family"] if family["title"].startswith(group)])


@pytest.mark.parametrize(("error", "group", "part"), CASES, ids=[f"{part}: {error}" for error, _, part in CASES])
def test_check_fails_on_a_planted_error(error: str, group: str, part: str) -> None:
    """Without the error it holds: see the tests of the reduced matrix."""
    subject = planted_subject(error)
    outcome = fill(subject, next(task for task in tasks_of(subject, group) if part in task.check.name))
    assert outcome.verdict is Verdict.FAILS
    assert not outcome.reason.startswith("uncaught")


def test_no_check_of_the_matrix_is_left_out(subject: Subject) -> None:
    checks = {task.check for task in all_tasks(subject)}
    covered = [(group, part) for _, group, part in CASES] + [("Order", part) for part in FOR_COMPARISON]
    assert not [
        check.name
        for check in checks
        if not any(check.group.startswith(group) and part in check.name for group, part in covered)
    ]


def account_of(error: str, group: str) -> dict[str, Verdict]:
    """Verdicts of the account after one group has run on a planted error."""
    subject = Subject(quick=True, edit=ERRORS[error])
    verdicts = {cell.check: cell.outcome.verdict for cell in run_matrix(subject, tasks_of(subject, group)).cells}
    return {kind: verdicts[check] for kind, check in ACCOUNT.items()}


@pytest.mark.parametrize(
    ("error", "group", "kind"),
    [
        ("not a number", "The lock", "not finite"),
        ("a viscous stress that drives", "Rates", "wrong-sided"),
        ("no look at the limit", "Compaction limit", "wrong-sided"),
        ("dissipation that falls", "The lock", "wrong-sided"),
    ],
)
def test_account_sees_what_no_cell_asked_for(error: str, group: str, kind: str) -> None:
    assert account_of(error, group)[kind] is Verdict.FAILS


def test_account_sees_a_refusal_without_a_message() -> None:
    """A call that asks for less without a word leaves the stress as it was: an answer of the wrong side."""
    assert Verdict.FAILS in account_of("no message", "Input").values()


def test_account_sees_an_exception(subject: Subject) -> None:
    check = tasks_of(subject, "Rates")[0].check
    broken = Task(check, "all", lambda: check.judge(1.0 / len([])))
    verdicts = {cell.check: cell.outcome.verdict for cell in run_matrix(Subject(quick=True), [broken]).cells}
    assert verdicts[check] is Verdict.FAILS
    assert verdicts[ACCOUNT["uncaught"]] is Verdict.FAILS
