"""The quadrature of the one-dimensional law against a stepwise witness, and under loads far from any test."""

from __future__ import annotations

import math

import numpy as np
import pytest

from law.stepwise import stepwise
from plyflow.case.case import Case, all_cases
from plyflow.law import LawParameters, LoadProgramme, batch, compaction_stress, integrate, integrate_batch, stage_curve

PROMISED = 1e-8


def constant_rate_error(law: LawParameters, rate: float, end: float, points: int, factor: float = 1.0) -> float:
    """Largest difference to eps = -rate t when the load is the stress of that motion, given at some points.

    At the start of the motion and at the lock the stress jumps; both jumps get a millionth of a reading's time.
    """
    lock_time = -law.eps_lock / rate
    step = end / points * 1e-6
    stages = [np.linspace(step, lock_time - step, points), np.linspace(lock_time, end, points)]
    strains = [-rate * times for times in stages]
    pressures = [-factor * compaction_stress(eps, np.full(eps.shape, -rate), law) for eps in strains]
    load = LoadProgramme((0.0, *np.concatenate(stages).tolist()), (0.0, *np.concatenate(pressures).tolist()))
    times = np.concatenate([stages[0][::7], stages[1][1::7]])
    eps = integrate(law, load, times).eps
    return float(np.max(np.abs(eps + rate * times)))


@pytest.mark.parametrize("column", [("IM7-8552", 90.0), ("IMA-M21", 60.0)])
def test_constant_rate_is_kept_by_the_stress_it_asks_for(column: tuple[str, float]) -> None:
    """Linear interpolation between readings leaves an error of second order; 8000 readings suffice for 1e-8."""
    law = Case(*column, "BP", 15.0).law()
    coarse, fine = (constant_rate_error(law, 1e-4, 2000.0, points) for points in (2000, 8000))
    assert fine < PROMISED
    assert coarse > 8.0 * fine
    assert constant_rate_error(law, 1e-4, 2000.0, 8000, factor=1.0 + 1e-5) > PROMISED  # a wrong stress is noticed


def check_stepwise(step: int = 1) -> None:
    """Every step-th case of both programmes against the witness; what is left is the witness's own error."""
    times = np.unique(np.concatenate([np.geomspace(1e-2, 1200.0, 60), np.linspace(0.0, 1200.0, 60)]))
    for case in (all_cases() + all_cases("monotonic"))[::step]:
        found = integrate(case.law(), case.load_programme, times)
        eps, lock_time = stepwise(case.law(), case.load_programme, times)
        assert np.max(np.abs(found.eps - eps)) < 1e-11, case.label
        assert np.array_equal(found.locked, times >= lock_time)
        assert (math.nan if found.lock_time is None else found.lock_time) == pytest.approx(lock_time, rel=5e-11, nan_ok=True)


def test_the_168_cases_meet_the_stepwise_witness() -> None:
    check_stepwise()


def test_many_cases_at_once_are_the_same_as_one_by_one() -> None:
    for cases in (all_cases()[::7], all_cases("monotonic")[::7]):
        for width in (15.0, 30.0):
            group = [case for case in cases if case.width == width]
            load, times = group[0].load_programme, np.linspace(0.0, 1200.0, 101)
            together = integrate_batch(batch([case.law() for case in group]), load, times)
            for row, case in enumerate(group):
                alone, one = integrate(case.law(), load, times), together.row(row)
                for name in ("eps", "thickness_ratio", "width_ratio", "fibre_fraction", "locked", "lock_time"):
                    np.testing.assert_allclose(
                        np.array(getattr(one, name), float), np.array(getattr(alone, name), float), rtol=1e-13
                    )


def test_a_wrong_quadrature_weight_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = stage_curve.LOG_WEIGHTS.copy()
    wrong[2] *= 1.0 + 1e-6
    monkeypatch.setattr(stage_curve, "LOG_WEIGHTS", wrong)
    with pytest.raises(AssertionError):
        check_stepwise(40)


def test_extreme_loads_stay_finite_and_above_the_limit() -> None:
    laws = batch([Case("IM7-8552", 30.0, "CP", 15.0).law(), Case("IMA-M21", 60.0, "BP", 15.0).law()])
    for pressure in (0.0, 1e-12, 1e-3, 1e3, 1e12):
        for duration in (1e-10, 1.0, 1e10):
            solution = integrate_batch(laws, LoadProgramme((0.0, duration), (pressure, pressure)))
            assert np.all(np.isfinite(solution.eps))
            assert np.all(solution.eps[:, 0] <= 0.0)
            assert np.all(solution.eps[:, 0] >= laws.eps_limit)
