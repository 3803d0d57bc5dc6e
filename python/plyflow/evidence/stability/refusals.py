"""Input that no answer exists for: each refused with its message, nothing changed."""

from __future__ import annotations

import numpy as np

from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.states import STAGES
from plyflow.evidence.stability.subject import Subject
from plyflow.evidence.stability.tensors import Array
from plyflow.umat.library import CallResult

UNIT, MOVED = np.eye(3), np.diag([1.0, 1.001, 0.999])
DEFORMATIONS = {
    "inverted": np.diag([1.0, 1.0, -1.0]),
    "singular": np.diag([1.0, 1.0, 0.0]),
    "zero": np.zeros((3, 3)),
    "rank one": np.ones((3, 3)),
    "NaN": np.full((3, 3), np.nan),
    "one NaN off the diagonal": np.array([[1.0, np.nan, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    "infinite": np.diag([1.0, 1.0, np.inf]),
    "overflowing": np.diag([1e200, 1e200, 1e200]),
}


def _judge(check: Check, answers: list[CallResult], stopped: bool = True) -> Outcome:
    for answer in answers:
        right = answer.stopped if stopped else not answer.stopped and 0.0 < answer.pnewdt <= 0.25
        if not (right and answer.messages.strip()):
            return check.fail(f"answered; message {answer.messages!r}, PNEWDT {answer.pnewdt:g}", 1.0)
    return check.refuse(answers[-1].messages, 0.0)


def _both_stages(subject: Subject, start: Array, end: Array, dt: float = 1.0) -> list[CallResult]:
    values = subject.values(subject.columns[0])
    return [subject.call(start, end, dt, values, locked) for locked in STAGES.values()]


def deformation_refused(check: Check, subject: Subject, form: str, side: str) -> Outcome:
    """No state at one end of the increment, in both stages."""
    start, end = (UNIT, DEFORMATIONS[form]) if side == "end" else (DEFORMATIONS[form], UNIT)
    return _judge(check, _both_stages(subject, start, end), stopped=side == "start")


def time_refused(check: Check, subject: Subject, dt: float) -> Outcome:
    """No time to take a rate over."""
    return _judge(check, _both_stages(subject, UNIT, MOVED, dt))


def plane_stress(check: Check, subject: Subject) -> Outcome:
    """NDI = 2: outside the law."""
    (library, _), props = subject.scene(), subject.props(subject.values(subject.columns[0]))
    answer = library.call(UNIT, UNIT, 1.0, props, subject.statev(), np.ones(3), ntens=3, ndi=2)
    if not np.array_equal(answer.stress, np.ones(3)):
        return check.fail("the stress was changed", 1.0)
    return _judge(check, [answer])


def counts(check: Check, subject: Subject) -> Outcome:
    """Arrays of another length than the scene's."""
    (library, _), props = subject.scene(), subject.props(subject.values(subject.columns[0]))
    size = len(subject.statev())
    sizes = ((props.size - 1, size), (props.size + 1, size), (props.size, size - 1))
    return _judge(check, [library.call(UNIT, UNIT, 1.0, np.resize(props, n), np.zeros(m)) for n, m in sizes])


def bad_state(check: Check, subject: Subject) -> Outcome:
    """A NaN handed in through STATEV must not come out as a stress."""
    (library, _), props = subject.scene(), subject.props(subject.values(subject.columns[0]))
    found, message = 0, ""
    for place in range(len(subject.statev())):
        statev = subject.statev()
        statev[place] = np.nan
        answer = library.call(UNIT, MOVED, 1.0, props, statev)
        message = message or answer.messages
        found += int(not (np.isfinite(answer.stress).all() and np.isfinite(answer.ddsdde).all()))
    return check.judge(found) if not message else check.refuse(message, found)
