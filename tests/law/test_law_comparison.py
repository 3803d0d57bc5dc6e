"""The comparison laws of Table 1: closed form against an integrator, the Newtonian limit, the match."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from plyflow.case.case import Case
from plyflow.errors import InputError
from plyflow.law import LoadProgramme
from plyflow.law.comparison import PowerSqueeze, matched, power_law_factor
from plyflow.run.law_run import histories

RAMPS = LoadProgramme((0.0, 2.0, 50.0, 60.0), (0.0, 0.1, 0.1, 0.3))


def equilibrium_error(law: PowerSqueeze, load: LoadProgramme, extra: float = 0.0) -> float:
    """Largest relative mismatch of the law's stress and the load at rates by central differences."""
    times = np.array([1.0, 10.0, 55.0])
    step = 1e-4
    rates = (law.eps(load, times + step) - law.eps(load, times - step)) / (2.0 * step)
    stress = np.exp(law.log_resistance - (law.n + 1.0 + extra) * law.eps(load, times)) * (-rates) ** law.n
    mismatch = stress / load.pressure(times) - 1.0
    return float(np.max(np.abs(mismatch)))


@pytest.mark.parametrize("n", [1.0, 0.5, 0.15])
def test_the_closed_form_carries_the_load(n: float) -> None:
    law = PowerSqueeze(n, -3.0, 15.0, 0.5)
    assert equilibrium_error(law, RAMPS) < 1e-6
    assert equilibrium_error(law, RAMPS, extra=1.0) > 1e-6  # another exponent of exp(-eps) is noticed


def test_newtonian_squeezing_meets_an_integrator() -> None:
    law = PowerSqueeze(1.0, 2.0, 15.0, 0.5)
    coefficient = math.exp(law.log_resistance)

    def rate(time: float, eps: np.ndarray) -> np.ndarray:
        return -RAMPS.pressure(time) / coefficient * np.exp(2.0 * eps)

    solution = solve_ivp(rate, (0.0, 60.0), [0.0], rtol=1e-12, atol=1e-14, max_step=1.0)
    assert law.eps(RAMPS, [60.0])[0] == pytest.approx(solution.y[0, -1], rel=1e-9)


def mean_pressure(n: float, aspect: float) -> float:
    """Mean pressure of lubrication flow between plates w apart by h = 1, unit consistency and unit strain rate.

    The flux at x is x; for a power-law fluid it is 2 n/(2 n + 1) (h/2)^((2 n + 1)/n) |dp/dx|^(1/n).
    """
    half = aspect / 2.0

    def gradient(x: float) -> float:
        return float((x * (2.0 * n + 1.0) / (2.0 * n)) ** n * 2.0 ** (2.0 * n + 1.0))

    return quad(lambda x: gradient(x) * x, 0.0, half, epsabs=0.0, epsrel=1e-12)[0] / half  # by parts


@pytest.mark.parametrize("n", [1.0, 0.4, 0.1])
def test_the_factor_of_the_power_law_is_that_of_lubrication_flow(n: float) -> None:
    assert power_law_factor(n) * 30.0 ** (n + 1.0) == pytest.approx(mean_pressure(n, 30.0), rel=1e-10)
    assert power_law_factor(n) * 30.0**n != pytest.approx(mean_pressure(n, 30.0), rel=1e-2)


def test_for_n_1_the_power_law_is_the_newtonian_one() -> None:
    assert power_law_factor(1.0) == 1.0


def test_both_laws_have_the_model_s_thickness_where_they_are_matched_and_no_limit_after() -> None:
    case = Case("IM7-8552", 70.0, "BP", 15.0)
    (history,) = histories([case], match_time=240.0)
    table = history.table()
    at_match = table[table["time_s"] == 240.0].iloc[0]
    end = table.iloc[-1]
    for name in ("rogers", "wang_gutowski"):
        assert at_match[f"thickness_ratio_{name}"] == pytest.approx(at_match["thickness_ratio"], rel=1e-12)
        assert end[f"thickness_ratio_{name}"] < history.summary()["thickness_ratio_limit"]
    assert end["thickness_ratio"] > history.summary()["thickness_ratio_limit"]


def test_nothing_to_match_and_impossible_exponents_are_refused() -> None:
    law = Case("IM7-8552", 70.0, "BP", 15.0).law()
    with pytest.raises(InputError, match="not compacted yet"):
        matched(law, 1.0, RAMPS, 0.0, 0.0)
    with pytest.raises(InputError, match="n = 0 must be above 0"):
        power_law_factor(0.0)
