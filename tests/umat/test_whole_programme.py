"""The paper's programme in the driver: no case fails, however it is iterated; width of the lock, thickness of the law.

Every case goes on with half its load taken off, so that one run shows the programme with and without a load drop at its end.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from plyflow.case.case import Case, all_cases, driver_steps, property_values, props_vector
from plyflow.driver.drive import History, drive
from plyflow.law import LawHistory, LoadProgramme, integrate
from plyflow.run.case_run import case_controls
from plyflow.umat.prepare import Umat, prepare_umat
from umat.planted import compiled, emit
from umat.test_umat_lock import NOT_WIDENED

CASES = {load: all_cases(load) for load in ("ramp-dwell", "monotonic")}
WIDTH, THICKNESS = 1e-4, 1e-3
WAYS = [(newton, extrapolation) for newton in ("power", "plain") for extrapolation in ("linear", "none")]


def with_drop(load: LoadProgramme) -> LoadProgramme:
    """The load, and in a second half of it taken off, for a minute."""
    end, last = load.times[-1], load.pressures[-1]
    return LoadProgramme((*load.times, end + 1.0, end + 60.0), (*load.pressures, last / 2, last / 2))


@cache
def laws(load: str) -> dict[str, LawHistory]:
    """The one-dimensional law at the end of each case of a load, by the case's label."""
    return {c.label: integrate(c.law(), c.load_programme, np.array([c.load_programme.end])) for c in CASES[load]}


def run(case: Case, umat: Umat, refinement: float, newton: Any, extrapolation: Any) -> History:
    props = np.array(props_vector(property_values(case, umat.manifest), umat.manifest))
    controls = replace(case_controls(refinement), newton=newton, extrapolation=extrapolation)
    steps = driver_steps(with_drop(case.load_programme))
    return drive(umat.library, props, len(umat.manifest["statev"]), steps, controls, temperature=case.temperature)


def errors(
    cases: Sequence[Case], umat: Umat, refinement: float, newton: str, extrapolation: str
) -> tuple[float, float]:
    """Largest errors of width and thickness ratio where the load drops; nothing moves much after it."""
    found = []
    for case in cases:
        history, law = run(case, umat, refinement, newton, extrapolation), laws(case.load)[case.label]
        assert history.completed, f"{case.label}: {history.message}"
        there = int(np.argmin(np.abs(history.time - case.load_programme.end)))
        end, after = (history.deformation_gradient[row].diagonal() for row in (there, -1))
        assert np.abs(after - end).max() < 1e-3, case.label
        found.append((abs(end[1] - law.width_ratio[-1]), abs(end[2] - law.thickness_ratio[-1])))
    return tuple(np.max(found, axis=0))  # type: ignore[return-value]


@pytest.mark.parametrize("load", CASES)
@pytest.mark.parametrize("refinement", [0.25, 1.0, 4.0])
@pytest.mark.parametrize(("newton", "extrapolation"), WAYS)
def test_no_case_fails_however_it_is_iterated(load: str, refinement: float, newton: str, extrapolation: str) -> None:
    width, thickness = errors(CASES[load], prepare_umat("default"), refinement, newton, extrapolation)
    assert width < WIDTH
    assert thickness < THICKNESS


@pytest.mark.parametrize(("newton", "extrapolation"), WAYS)
def test_nor_with_the_backward_difference(newton: str, extrapolation: str) -> None:
    """At increments as shipped; 4 times shorter the cold monotonic cases, whose attempts may begin after the snap at the lock."""
    umat = prepare_umat("bdf1")
    cold = [case for case in CASES["monotonic"] if case.temperature == 30.0]
    for cases, refinement in ((CASES["ramp-dwell"], 1.0), (cold, 4.0)):
        width, thickness = errors(cases, umat, refinement, newton, extrapolation)
        assert width < WIDTH
        assert thickness < THICKNESS


def test_a_lock_without_its_push_is_seen() -> None:
    umat = replace(prepare_umat("bdf1"), library=compiled(emit(), *NOT_WIDENED))
    assert errors(CASES["ramp-dwell"][6:9], umat, 0.25, "power", "linear")[0] > WIDTH
