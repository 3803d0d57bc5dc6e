"""Input that no answer exists for: each refused with its message, nothing changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from plyflow.evidence.stability.bench import N_STATEV, Bench, statev_at_start
from plyflow.evidence.stability.cells import WHOLE, Check, Outcome, Task
from plyflow.evidence.stability.states import STAGES
from plyflow.evidence.stability.tensors import Array
from plyflow.umat.library import CallResult

GROUP = "Input without an answer"
MEASURES = "answers given"
ONE_BAD = np.eye(3) + np.array([[0.0, np.nan, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
DEFORMATIONS: Mapping[str, Array] = {
    "inverted": np.diag([1.0, 1.0, -1.0]),
    "singular": np.diag([1.0, 1.0, 0.0]),
    "zero": np.zeros((3, 3)),
    "rank one": np.ones((3, 3)),
    "NaN": np.full((3, 3), np.nan),
    "one NaN off the diagonal": ONE_BAD,
    "infinite": np.diag([1.0, 1.0, np.inf]),
    "overflowing": np.diag([1e200, 1e200, 1e200]),
}
TIMES = (0.0, -1.0, 1e-200, float("nan"), float("inf"))
ENDS = {
    name: Check(GROUP, f"end of the increment {name}: a smaller increment asked for", MEASURES, 0.0, may_refuse=True)
    for name in DEFORMATIONS
}
STARTS = {
    name: Check(GROUP, f"start of the increment {name}: the analysis ends", MEASURES, 0.0, may_refuse=True)
    for name in DEFORMATIONS
}
CLOCKS = {dt: Check(GROUP, f"dt = {dt:g} s: the analysis ends", MEASURES, 0.0, may_refuse=True) for dt in TIMES}
PLANE_STRESS = Check(GROUP, "plane stress (NDI = 2): the analysis ends", MEASURES, 0.0, may_refuse=True)
COUNTS = Check(
    GROUP, "too few or too many constants, too few state variables: the analysis ends", MEASURES, 0.0, may_refuse=True
)
BAD_STATE = Check(
    GROUP, "NaN in the state variables: no NaN in an answer", "NaN in stress or tangent", 0.0, may_refuse=True
)


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for name, matrix in DEFORMATIONS.items():
        yield Task(ENDS[name], WHOLE, partial(end_refused, bench, ENDS[name], matrix))
        yield Task(STARTS[name], WHOLE, partial(start_refused, bench, STARTS[name], matrix))
    for dt, check in CLOCKS.items():
        yield Task(check, WHOLE, partial(time_refused, bench, check, dt))
    yield Task(PLANE_STRESS, WHOLE, partial(plane_stress, bench))
    yield Task(COUNTS, WHOLE, partial(counts, bench))
    yield Task(BAD_STATE, WHOLE, partial(bad_state, bench))


def _judge(check: Check, answers: list[CallResult], stopped: bool) -> Outcome:
    for answer in answers:
        right = answer.stopped if stopped else not answer.stopped and 0.0 < answer.pnewdt <= 0.25
        if not (right and answer.messages.strip()):
            return check.fail(f"answered; message {answer.messages!r}, PNEWDT {answer.pnewdt:g}", 1.0)
    return check.refuse(answers[-1].messages, 0.0)


def end_refused(bench: Bench, check: Check, matrix: Array) -> Outcome:
    """No answer at the end of the increment, in both stages."""
    values = bench.values(bench.columns[0])
    answers = [bench.call(np.eye(3), matrix, 1.0, values, locked) for locked in STAGES.values()]
    return _judge(check, answers, stopped=False)


def start_refused(bench: Bench, check: Check, matrix: Array) -> Outcome:
    """No state at the start of the increment, in both stages."""
    values = bench.values(bench.columns[0])
    answers = [bench.call(matrix, np.eye(3), 1.0, values, locked) for locked in STAGES.values()]
    return _judge(check, answers, stopped=True)


def time_refused(bench: Bench, check: Check, dt: float) -> Outcome:
    """No time to take a rate over."""
    values = bench.values(bench.columns[0])
    end = np.diag([1.0, 1.001, 0.999])
    return _judge(check, [bench.call(np.eye(3), end, dt, values, locked) for locked in STAGES.values()], stopped=True)


def plane_stress(bench: Bench) -> Outcome:
    """NDI = 2: outside the law."""
    library, values = bench.scene().library, bench.values(bench.columns[0])
    answer = library.call(
        np.eye(3), np.eye(3), 1.0, bench.props(values), statev_at_start(False), np.ones(3), ntens=3, ndi=2
    )
    if not np.array_equal(answer.stress, np.ones(3)):
        return PLANE_STRESS.fail("the stress was changed", 1.0)
    return _judge(PLANE_STRESS, [answer], stopped=True)


def counts(bench: Bench) -> Outcome:
    """Arrays of another length than the scene's."""
    library, props = bench.scene().library, bench.props(bench.values(bench.columns[0]))
    unit = np.eye(3)
    answers = [
        library.call(unit, unit, 1.0, np.resize(props, props.size + more), np.zeros(N_STATEV)) for more in (-1, 1)
    ]
    answers.append(library.call(unit, unit, 1.0, props, np.zeros(N_STATEV - 1)))
    return _judge(COUNTS, answers, stopped=True)


def bad_state(bench: Bench) -> Outcome:
    """A NaN handed in through STATEV must not come out as a stress."""
    library, props = bench.scene().library, bench.props(bench.values(bench.columns[0]))
    found, message = 0, ""
    for place in range(N_STATEV):
        statev = np.zeros(N_STATEV)
        statev[place] = np.nan
        answer = library.call(np.eye(3), np.diag([1.0, 1.001, 0.999]), 1.0, props, statev)
        message = message or answer.messages
        finite = np.isfinite(answer.stress).all() and np.isfinite(answer.ddsdde).all()
        found += int(not finite)
    return BAD_STATE.judge(found) if not message else BAD_STATE.refuse(message, found)
