"""Load programmes and the load clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest

from plyflow.case.programme import load_programme
from plyflow.errors import InputError
from plyflow.law import LoadClock, LoadProgramme
from plyflow.law.load import power_duration, power_integral

PIECES = [
    (1.0, 0.0, 1.0, 21.7),
    (240.0, 0.3, 0.3, 21.7),
    (7.0, 0.4, 0.4 * (1.0 + 1e-13), 4.0),
    (3.0, 0.9, 0.1, 0.7),
    (2.0, 1e-30, 1.0, 5.0),
]


def check_power_integral(function: Callable[..., Any]) -> None:
    mpmath.mp.dps = 30
    for duration, first, last, power in PIECES:
        slope = (mpmath.mpf(last) - first) / duration
        points = [mpmath.mpf(duration) * part / 8 for part in range(9)]
        exact = mpmath.quad(lambda t, f=first, s=slope, n=power: (f + s * t) ** n, points)
        assert float(function(duration, first, last, power)) == pytest.approx(float(exact), rel=1e-12)


def cancelling(duration: float, first: float, last: float, power: float) -> float:
    if first == last:
        return float(duration * first**power)
    return float(duration * (last ** (power + 1) - first ** (power + 1)) / ((power + 1) * (last - first)))


def test_power_integral_is_exact_for_steep_flat_and_falling_pieces() -> None:
    check_power_integral(power_integral)
    with pytest.raises(AssertionError):  # cancellation on nearly flat pieces is noticed
        check_power_integral(cancelling)


def test_the_clock_adds_up_and_can_be_read_backwards() -> None:
    load = load_programme("ramp-dwell", 15.0)
    for exponent, start in ((21.7, 0.0), (5.0, 0.4), (3.7, 300.0)):
        clock = LoadClock(load, exponent)
        assert float(clock.at(0.0)[0, 0]) == 0.0
        for time in (start + 1e-3, start + 0.5, 481.5, 1199.0, 1200.0):
            theta = float(clock.at(time)[0, 0])
            assert clock.time(theta)[0] == pytest.approx(time, rel=1e-9)
        exact = sum(
            float(power_integral(end - begin, first / load.peak, last / load.peak, exponent))
            for begin, end, first, last in load.pieces()
        )
        assert clock.at(1200.0)[0, 0] == clock.total[0] == pytest.approx(exact, rel=1e-13)


def test_a_falling_load_counts_by_its_own_power_and_clocks_keep_apart() -> None:
    load = LoadProgramme((0.0, 1.0, 2.0, 50.0), (1.0, 1.0, 0.1, 0.1))
    readings = LoadClock(load, [21.7, 3.0]).at([40.0, 50.0])
    assert np.diff(readings[1])[0] == pytest.approx(10.0 * 0.1**3.0, rel=1e-9)
    assert readings[0] == pytest.approx(LoadClock(load, 21.7).at([40.0, 50.0])[0], rel=1e-15)


def check_ramp_dwell(load: LoadProgramme, forces: list[float], width: float) -> None:
    assert load.times == (0.0, 1.0, 240.0, 241.0, 480.0, 481.0, 720.0, 721.0, 960.0, 961.0, 1200.0)
    dwell = load.pressure([100.0, 300.0, 600.0, 800.0, 1100.0]) * width * width
    assert np.max(np.abs(dwell / forces - 1.0)) < 1e-14
    assert float(load.pressure(0.5)) == pytest.approx(0.5 * forces[0] / width**2, rel=1e-14)


@pytest.mark.parametrize(("width", "first"), [(15.0, 20.0), (30.0, 80.0)])
def test_ramp_dwell_holds_the_paper_s_five_levels_240_s_each_ramps_included(width: float, first: float) -> None:
    forces = [factor * first for factor in (1.0, 1.5, 2.0, 2.5, 3.0)]
    check_ramp_dwell(load_programme("ramp-dwell", width), forces, width)
    with pytest.raises(AssertionError):  # a level too high is noticed
        check_ramp_dwell(load_programme("ramp-dwell", width), [*forces[:4], forces[4] + 1.0], width)


def test_monotonic_load_rises_linearly_to_the_last_level() -> None:
    assert load_programme("monotonic", 30.0) == LoadProgramme((0.0, 1200.0), (0.0, 240.0 / 900.0))


def test_other_widths_take_the_baseline_s_pressures() -> None:
    assert load_programme("ramp-dwell", 22.0).pressures == pytest.approx(
        load_programme("ramp-dwell", 15.0).pressures, rel=1e-14
    )


@pytest.mark.parametrize(
    ("times", "pressures", "message"),
    [
        ((0.0,), (1.0,), "at least two"),
        ((0.0, 1.0), (1.0,), "as many pressures"),
        ((1.0, 2.0), (0.0, 1.0), "start at 0"),
        ((0.0, 1.0, 1.0), (0.0, 1.0, 2.0), "increase strictly"),
        ((0.0, 1.0), (0.0, -1.0), "must not be below 0"),
        ((0.0, math.inf), (0.0, 1.0), "finite"),
    ],
)
def test_faulty_programmes_are_refused(times: tuple[float, ...], pressures: tuple[float, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        LoadProgramme(times, pressures)


def test_power_duration_inverts_power_integral() -> None:
    for duration, first, last, power in PIECES:
        integral = float(power_integral(duration, first, last, power))
        slope = (last - first) / duration
        assert power_duration(integral, first, slope, power) == pytest.approx(duration, rel=1e-9)
        tiny = 1e-20 * duration
        gathered = float(power_integral(tiny, first, first + slope * tiny, power))
        if gathered > 0.0:
            assert power_duration(gathered, first, slope, power) == pytest.approx(tiny, rel=1e-9)
