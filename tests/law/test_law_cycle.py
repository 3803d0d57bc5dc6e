"""The law through a changing temperature: against the isothermal quadrature, an ODE solver, and hand-made cases of the lock."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from plyflow.case.case import Case
from plyflow.case.solution import law_at, laws_of, solve
from plyflow.law import LawHistory, LoadProgramme, Stage, integrate, log_viscosity
from plyflow.law.cycle import integrate_cycle, stretches
from plyflow.law.time_left import time_left

CASE = Case("IM7-8552", 70.0, "CP", 15.0)
RAMP = LoadProgramme((0.0, 1.0, 241.0, 600.0), (0.0, 0.1, 0.1, 0.2), (), (50.0, 50.0, 80.0, 80.0))
COOLING = LoadProgramme((0.0, 1.0, 600.0, 1200.0), (0.0, 0.25, 0.25, 0.25), (), (90.0, 90.0, 90.0, 50.0))


def ode(case: Case, load: LoadProgramme, times: np.ndarray, begin: float, eps: float, locked: bool = True) -> np.ndarray:
    """Compaction at times [s] by LSODA from eps at a time on; the constants anew at every call."""

    def rate(time: float, state: np.ndarray) -> list[float]:
        law = law_at(case, float(load.temperature(time)))
        if state[0] <= law.eps_limit:
            return [0.0]
        stage = Stage.BLEED if locked else Stage.SQUEEZE
        log_p = math.log(max(float(load.pressure(time)), 1e-300))
        return [-math.exp(law.rate_exponent * (log_p - float(log_viscosity(state[0], law, stage))))]

    done = solve_ivp(rate, (begin, times[-1]), [eps], "LSODA", times, rtol=1e-9, atol=1e-11, max_step=5.0)
    assert done.success
    return np.asarray(done.y[0])


def ends(history: LawHistory) -> tuple[float, float, float]:
    return float(history.thickness_ratio[-1]), float(history.width_ratio[-1]), float(history.fibre_fraction[-1])


@pytest.mark.parametrize("layup", ["CP", "BP"])
def test_a_cycle_of_one_temperature_is_the_isothermal_run(layup: str) -> None:
    case = replace(CASE, layup=layup)
    load = case.load_programme
    held = replace(load, temperatures=(70.0,) * len(load.times))
    times = np.linspace(0.0, load.end, 101)
    one, other = integrate(case.law(), load, times), solve([case], held, times).row(0)
    np.testing.assert_allclose(other.thickness_ratio, one.thickness_ratio, rtol=0, atol=1e-12)  # the same quadrature
    np.testing.assert_allclose(other.width_ratio, one.width_ratio, rtol=0, atol=1e-12)
    assert other.lock_time == pytest.approx(one.lock_time, rel=1e-9)
    warmer = solve([case], replace(load, temperatures=(71.0,) * len(load.times)), times).row(0)
    assert np.abs(warmer.thickness_ratio - one.thickness_ratio).max() > 1e-4  # one degree more is noticed


def error_of_ramp(changed: float) -> float:
    """Largest difference to the ODE solver on the heated ramp, from 20 s on; the witness a factor off in pressure if wanted."""
    times = np.linspace(20.0, 600.0, 59)
    found = solve([CASE], RAMP, times).row(0)
    assert found.locked.all()
    wrong = replace(RAMP, pressures=tuple(changed * value for value in RAMP.pressures))
    return float(np.abs(found.eps - ode(CASE, wrong, times, 20.0, float(found.eps[0]))).max())


def test_a_ramp_is_what_an_ode_solver_finds() -> None:
    """From 20 s on, when it bleeds: 1e-5 is the stated error of stretches of 0.125 K at 7.5 K a minute."""
    assert error_of_ramp(1.0) < 1e-5
    assert error_of_ramp(1.01) > 5e-5  # a load 1 % off is noticed


def test_the_scheme_is_of_second_order_in_the_stretches() -> None:
    finals = [
        float(integrate_cycle(laws_of([CASE]), RAMP, [241.0], largest_change=size).eps[0, 0]) for size in (4.0, 2.0, 1.0, 0.125)
    ]
    errors = np.abs(np.array(finals[:3]) - finals[3])
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.2)


def test_the_lock_is_judged_at_the_current_eps_lock() -> None:
    """Slowly loaded at 30 degC the ply locks at exp(-eps_lock) of 30 degC; heated first, later and wider."""
    cold = LoadProgramme((0.0, 600.0), (0.0, 0.25), (), (30.0, 30.0))
    heated = LoadProgramme((0.0, 300.0, 600.0), (0.0, 0.0, 0.25), (), (30.0, 80.0, 80.0))
    case = replace(CASE, layup="BP")
    for load, temperature in ((cold, 30.0), (heated, 80.0)):
        found = solve([case], load, np.array([load.end])).row(0)
        assert found.locked[-1]
        assert found.width_ratio[-1] == pytest.approx(math.exp(-law_at(case, temperature).eps_lock), rel=1e-9)


def test_cooling_brings_the_lock_to_the_ply() -> None:
    """Compacted at 80 degC to short of its lock and cooled without pressure: it locks where eps_lock(T) = eps."""
    case = replace(CASE, layup="BP")
    load = LoadProgramme((0.0, 60.0, 61.0, 1261.0), (0.0, 3e-3, 0.0, 0.0), (), (80.0, 80.0, 80.0, 30.0))
    found = solve([case], load, np.linspace(0.0, load.end, 201)).row(0)
    eps = float(found.eps[-1])
    assert law_at(case, 80.0).eps_lock < eps < law_at(case, 30.0).eps_lock
    assert found.lock_time is not None
    at_lock = law_at(case, float(load.temperature(found.lock_time))).eps_lock
    assert at_lock == pytest.approx(eps, abs=5e-4)  # a stretch of 0.125 K moves eps_lock by up to 4e-4
    assert found.width_ratio[-1] == pytest.approx(math.exp(-eps), rel=1e-12)


def test_a_ply_that_cooling_leaves_beyond_the_limit_stands_still() -> None:
    case = replace(CASE, layup="BP")
    found = solve([case], COOLING, np.linspace(0.0, 1200.0, 121)).row(0)
    assert found.still_time is not None
    limit = law_at(case, float(COOLING.temperature(found.still_time))).eps_limit
    assert limit == pytest.approx(float(found.eps[-1]), abs=2e-3)
    assert found.eps[-1] == found.eps[found.time >= found.still_time][0]
    assert solve([CASE], RAMP, np.array([600.0])).row(0).still_time is None


def test_time_left_is_what_the_law_then_takes() -> None:
    load = LoadProgramme((0.0, 1e30), (0.2, 0.2))
    law = CASE.law()
    for start in (0.5, 20.0):  # before the lock and after it
        now = integrate(law, load, [start])
        batch_of = laws_of([CASE])(np.array([70.0])).each(lambda values: values[0])
        left = float(time_left(batch_of, now.eps, now.locked, np.array([0.2]))[0])
        then = integrate(law, load, [start + left])
        assert then.eps[0] - law.eps_limit == pytest.approx(math.log(1.01), rel=1e-6)
    assert math.isinf(time_left(batch_of, now.eps, now.locked, np.zeros(1))[0])
    assert time_left(batch_of, np.array([law.eps_limit]), np.array([True]), np.ones(1))[0] == 0.0


def test_dwells_are_stretches_of_their_own_and_ramps_are_cut() -> None:
    load = LoadProgramme((0.0, 100.0, 160.0, 300.0), (0.0, 0.1, 0.1, 0.1), (), (50.0, 50.0, 53.0, 53.0))
    marks = stretches(load, 1.0)
    np.testing.assert_allclose(marks, [0.0, 100.0, 120.0, 140.0, 160.0, 300.0])
