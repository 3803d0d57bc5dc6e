"""The quadrature of the one-dimensional law against closed forms in mpmath and against a stepwise witness.

Newtonian limit, a = 0: with u = exp(eps), c = exp(eps_limit), the viscosities of both stages are rational in u, and
so is the time to reach a compaction under constant pressure. Any a, bleed: with v = c/u the time is an incomplete
beta function. Constant rate: the pressure that Eqs. 1 to 5 ask for is fed back as the load.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

from law.stepwise import stepwise
from plyflow.case.case import Case, all_cases
from plyflow.law import LawParameters, LoadProgramme, batch, compaction_stress, integrate, integrate_batch, stage_curve
from plyflow.law.equations import Stage, log_viscosity

PROMISED = 1e-8
mpf = mpmath.mpf
COLUMNS = [(name, temperature) for name in ("IM7-8552", "IMA-M21") for temperature in (30.0, 50.0, 70.0, 90.0)]


def newtonian() -> LawParameters:
    """A Newtonian ply that squeezes for 20 s and then bleeds."""
    law = Case("IM7-8552", 70.0, "BP", 15.0, settings={"a": 0.0, "b_squeeze": -8.0, "b_bleed": -24.73}).law()
    assert law.a == 0.0
    return law


def newtonian_antiderivative(law: LawParameters, u: Any, stage: Stage) -> Any:
    """Antiderivative over eps of the printed viscosity without its constant factor, as a function of u = exp(eps).

    Squeeze: u^-3 ((u/c-1)^-2 + 3); bleed: u^-2 (u/c-1)^-2; both divided by u for d eps = du/u.
    """
    c = mpmath.sqrt(mpf(law.chi_ratio)) * mpf(law.k) * mpmath.exp(mpf(law.eps_lock))
    r = u / c
    log = mpmath.log((r - 1) / r)
    if stage is Stage.SQUEEZE:  # integral of r^-4 (r-1)^-2 dr and of 3 r^-4 dr
        return c**-3 * (-4 * log - 1 / (r - 1) - 3 / r - 1 / r**2 - 1 / (3 * r**3) - 1 / r**3)
    return c**-2 * (-3 * log - 1 / (r - 1) - 2 / r - 1 / (2 * r**2))  # integral of r^-3 (r-1)^-2 dr


def newtonian_time(law: LawParameters, eps: float, pressure: float) -> Any:
    """Time [s] to reach a compaction under constant pressure, a = 0."""
    lock = mpf(law.eps_lock)
    ratio = 2 * (mpf(law.w0) / law.h0) ** 2 * 2 * mpf(law.k) / mpf(pressure)
    factors = {
        Stage.SQUEEZE: ratio * mpmath.exp(-lock) * mpmath.exp(mpf(law.b_squeeze)),
        Stage.BLEED: ratio * mpmath.exp(-2 * lock) * mpf(law.l0_over_d) ** 2 * mpmath.exp(mpf(law.b_bleed)),
    }

    def spent(start: Any, end: Any, stage: Stage) -> Any:
        ends = (newtonian_antiderivative(law, mpmath.exp(mpf(value)), stage) for value in (start, end))
        first, last = ends
        return factors[stage] * (first - last)

    if eps > law.eps_lock:
        return spent(0, eps, Stage.SQUEEZE)
    return spent(0, lock, Stage.SQUEEZE) + spent(lock, eps, Stage.BLEED)


def rate_error(law: LawParameters, time: Any, wanted: float, eps: float, pressure: float) -> float:
    """Error of eps from the error in time, by the rate."""
    stage = law.stage(eps)
    rate = math.exp(law.rate_exponent * (math.log(pressure) - float(log_viscosity(eps, law, stage))))
    return abs(float(time - wanted)) * rate


def newtonian_error(law: LawParameters) -> float:
    mpmath.mp.dps = 30
    pressure = 0.1
    load = LoadProgramme((0.0, 2000.0), (pressure, pressure))
    times = [1e-3, 0.5, 3.0, 30.0, 2000.0]
    solution = integrate(law, load, times)
    assert {True, False} == set(solution.locked.tolist())
    return max(
        rate_error(law, newtonian_time(law, float(eps), pressure), time, float(eps), pressure)
        for time, eps in zip(times, solution.eps, strict=True)
    )


def test_the_newtonian_limit_meets_its_closed_form() -> None:
    assert newtonian_error(newtonian()) < PROMISED


def test_a_power_one_millionth_off_newtonian_is_noticed() -> None:
    law = newtonian()
    load = LoadProgramme((0.0, 2000.0), (0.1, 0.1))
    eps = integrate(replace(law, a=1e-6), load, [30.0]).eps[0]
    assert rate_error(law, newtonian_time(law, float(eps), 0.1), 30.0, float(eps), 0.1) > PROMISED


def bleed_time(law: LawParameters, start: Any, end: Any, pressure: float) -> Any:
    """Time [s] to bleed between two compactions under constant pressure: an incomplete beta function.

    With v = exp(eps_limit - eps), (eta exp(b))^m d(-eps) is proportional to v^(4 m - 1) (1 - v)^(-2 m) dv.
    """
    m = 1 / (mpf(law.a) + 1)
    lock = mpf(law.eps_lock)
    limit = mpmath.log(mpf(law.k)) + mpmath.log(mpf(law.chi_ratio)) / 2 + lock
    scale = 4 * (mpf(law.w0) / law.h0 * mpf(law.l0_over_d)) ** 2 * mpf(law.k) * mpmath.exp(mpf(law.b_bleed) - 2 * lock)
    first, last = mpmath.exp(limit - start), mpmath.exp(limit - end)
    power, singular = 4 * m, 1 - 2 * m

    def antiderivative(v: Any) -> Any:
        return v**power / power * mpmath.hyp2f1(power, 1 - singular, power + 1, v)

    return (scale * mpmath.exp(-2 * limit) / pressure) ** m * (antiderivative(last) - antiderivative(first))


def near_limit_error(law: LawParameters, pressure: float, duration: float) -> tuple[float, float]:
    """Largest error of eps in the bleed stage, and the last distance to the limit."""
    mpmath.mp.dps = 60
    load = LoadProgramme((0.0, duration), (pressure, pressure))
    lock_time = integrate(law, load).lock_time
    assert lock_time is not None
    times = np.geomspace(max(10.0 * lock_time, duration * 1e-6), duration, 5)
    eps = integrate(law, load, times).eps
    errors = []
    for time, value in zip(times, eps, strict=True):
        spent = bleed_time(law, mpf(law.eps_lock), mpf(float(value)), pressure) + mpf(float(lock_time))
        errors.append(rate_error(law, spent, float(time), float(value), pressure))
    return max(errors), float(eps[-1] - law.eps_limit)


@pytest.mark.parametrize(("name", "temperature"), COLUMNS)
def test_constant_pressure_near_the_limit_meets_its_closed_form(name: str, temperature: float) -> None:
    law = Case(name, temperature, "BP", 15.0).law()
    error, gap = near_limit_error(law, 50.0, 1e6)
    assert error < PROMISED
    assert 0.0 < gap < 0.05


def test_a_limit_off_by_a_millionth_is_noticed() -> None:
    law = Case("IMA-M21", 50.0, "BP", 15.0).law()
    load = LoadProgramme((0.0, 1e6), (50.0, 50.0))
    eps = float(integrate(replace(law, k=law.k * (1.0 + 1e-6)), load, [load.end]).eps[0])
    spent = bleed_time(law, mpf(law.eps_lock), mpf(eps), 50.0)
    assert rate_error(law, spent, 1e6, eps, 50.0) > PROMISED


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
    """Linear interpolation between readings leaves an error of second order; 4000 readings suffice for 1e-8."""
    law = Case(*column, "BP", 15.0).law()
    coarse, fine = (constant_rate_error(law, 1e-4, 2000.0, points) for points in (1000, 4000))
    assert fine < PROMISED
    assert coarse > 8.0 * fine
    assert constant_rate_error(law, 1e-4, 2000.0, 4000, factor=1.0 + 1e-5) > PROMISED  # a wrong stress is noticed


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
