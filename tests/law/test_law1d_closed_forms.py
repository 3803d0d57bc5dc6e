"""The vectorised one-dimensional law against closed forms, in mpmath from the printed equations.

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
from plyflow.case.law_case import LawCase
from plyflow.law.batch import batch

from plyflow.case.case import all_cases
from plyflow.case.programme import load_programme
from plyflow.law import LawParameters, LoadProgramme, compaction_stress, integrate, stage_curve
from plyflow.law.equations import Stage, log_viscosity
from plyflow.law.integration import integrate_batch

PROMISED = 1e-8
mpf = mpmath.mpf
COLUMNS = [(name, temperature) for name in ("IM7-8552", "IMA-M21") for temperature in (30.0, 50.0, 70.0, 90.0)]


def newtonian() -> LawParameters:
    """A Newtonian ply that squeezes for 20 s and then bleeds."""
    law = LawCase("IM7-8552", 70.0, "BP", 15.0, {"a": 0.0, "b_squeeze": -8.0, "b_bleed": -24.73}).law()
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
    solution = integrate_batch(batch([law]), load, times)
    assert {True, False} == set(solution.locked[0].tolist())
    return max(
        rate_error(law, newtonian_time(law, float(eps), pressure), time, float(eps), pressure)
        for time, eps in zip(times, solution.eps[0], strict=True)
    )


def test_the_newtonian_limit_meets_its_closed_form() -> None:
    assert newtonian_error(newtonian()) < PROMISED


def test_a_power_one_millionth_off_newtonian_is_noticed() -> None:
    law = newtonian()
    load = LoadProgramme((0.0, 2000.0), (0.1, 0.1))
    eps = integrate_batch(batch([replace(law, a=1e-6)]), load, [30.0]).eps[0, 0]
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
    lock_time = integrate_batch(batch([law]), load).lock_time[0]
    times = np.geomspace(max(10.0 * lock_time, duration * 1e-6), duration, 5)
    eps = integrate_batch(batch([law]), load, times).eps[0]
    assert np.isfinite(lock_time)
    errors = []
    for time, value in zip(times, eps, strict=True):
        spent = bleed_time(law, mpf(law.eps_lock), mpf(float(value)), pressure) + mpf(float(lock_time))
        errors.append(rate_error(law, spent, float(time), float(value), pressure))
    return max(errors), float(eps[-1] - law.eps_limit)


@pytest.mark.parametrize(("name", "temperature"), COLUMNS)
def test_constant_pressure_near_the_limit_meets_its_closed_form(name: str, temperature: float) -> None:
    law = LawCase(name, temperature, "BP", 15.0).law()
    error, gap = near_limit_error(law, 50.0, 1e6)
    assert error < PROMISED
    assert 0.0 < gap < 0.05


def test_a_limit_off_by_a_millionth_is_noticed() -> None:
    law = LawCase("IMA-M21", 50.0, "BP", 15.0).law()
    load = LoadProgramme((0.0, 1e6), (50.0, 50.0))
    eps = float(integrate_batch(batch([replace(law, k=law.k * (1.0 + 1e-6))]), load).eps[0, 0])
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
    eps = integrate_batch(batch([law]), load, times).eps[0]
    return float(np.max(np.abs(eps + rate * times)))


@pytest.mark.parametrize("column", [("IM7-8552", 90.0), ("IMA-M21", 60.0)])
def test_constant_rate_is_kept_by_the_stress_it_asks_for(column: tuple[str, float]) -> None:
    """Linear interpolation between readings leaves an error of second order; 4000 readings suffice for 1e-8."""
    law = LawCase(*column, "BP", 15.0).law()
    coarse, fine = (constant_rate_error(law, 1e-4, 2000.0, points) for points in (1000, 4000))
    assert fine < PROMISED
    assert coarse > 8.0 * fine
    assert constant_rate_error(law, 1e-4, 2000.0, 4000, factor=1.0 + 1e-5) > PROMISED  # a wrong stress is noticed


def worst_difference() -> float:
    """Largest difference of eps to the stepwise integrator over a seventh of the programme, both loads."""
    times = np.unique(np.concatenate([np.geomspace(1e-2, 1200.0, 60), np.linspace(0.0, 1200.0, 60)]))
    worst = 0.0
    for load_name in ("ramp-dwell", "monotonic"):
        for width in (15.0, 30.0):
            cases = [case for case in all_cases() if case.width == width][::7]
            laws = [LawCase(case.material, case.temperature, case.layup, case.width).law() for case in cases]
            load = load_programme(load_name, width)
            solution = integrate_batch(batch(laws), load, times)
            for row, law in enumerate(laws):
                reference = integrate(law, load, times)
                worst = max(worst, float(np.max(np.abs(solution.eps[row] - reference.eps))))
                assert np.array_equal(solution.locked[row], reference.locked)
                lock = math.nan if reference.lock_time is None else reference.lock_time
                np.testing.assert_allclose(solution.lock_time[row], lock, rtol=1e-9)
                np.testing.assert_allclose(solution.width_ratio[row], reference.width_ratio, rtol=1e-10)
                np.testing.assert_allclose(solution.fibre_fraction[row], reference.fibre_fraction, rtol=1e-10)
    return worst


def check_stepwise() -> None:
    assert worst_difference() < 1e-11


def test_many_cases_at_once_meet_the_stepwise_integrator() -> None:
    check_stepwise()


def test_a_wrong_quadrature_weight_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = stage_curve.LOG_WEIGHTS.copy()
    wrong[2] *= 1.0 + 1e-6
    monkeypatch.setattr(stage_curve, "LOG_WEIGHTS", wrong)
    with pytest.raises(AssertionError):
        check_stepwise()


def test_extreme_loads_stay_finite_and_above_the_limit() -> None:
    laws = batch([LawCase("IM7-8552", 30.0, "CP", 15.0).law(), LawCase("IMA-M21", 60.0, "BP", 15.0).law()])
    for pressure in (0.0, 1e-12, 1e-3, 1e3, 1e12):
        for duration in (1e-10, 1.0, 1e10):
            solution = integrate_batch(laws, LoadProgramme((0.0, duration), (pressure, pressure)))
            assert np.all(np.isfinite(solution.eps))
            assert np.all(solution.eps[:, 0] <= 0.0)
            assert np.all(solution.eps[:, 0] >= laws.eps_limit)
