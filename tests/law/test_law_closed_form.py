"""The one-dimensional law against its separable closed form, in mpmath from the printed equations.

Under (p / (eta exp(b)))^m = -d eps/dt, m = 1/(a+1), the variables separate:
    integral of (eta exp(b))^m d(-eps)  =  integral of p^m dt.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plyflow.case.case import Case
from plyflow.case.programme import load_programme
from plyflow.errors import InputError
from plyflow.law import (
    LawHistory,
    LawParameters,
    LoadProgramme,
    Stage,
    bulk_lock_strain,
    compaction_stress,
    equations,
    integrate,
    lock_strain,
)
from plyflow.law.equations import log_eta_ply

# A thousandth of the 1e-9 that users are promised; the quadrature itself is exact to rounding.
LARGEST_ERROR = 1e-12
COLUMNS = [(name, t) for name in ("IM7-8552", "IMA-M21") for t in (30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)]


def published_law(name: str, temperature: float, layup: str = "CP", width: float = 15.0) -> LawParameters:
    return Case(name, temperature, layup, width, settings={"gamma_lock": 80.0}).law()


def printed_viscosity(law: LawParameters, eps: Any, bleed: bool) -> Any:
    """eta_ply eta_micro exp(b) as printed in Eqs. 4 and 5, in mpmath numbers."""
    mpf = mpmath.mpf
    lock, k = mpf(law.eps_lock), mpf(law.k)
    chi_l = mpmath.exp(-2 * lock)
    gap = k / (mpmath.sqrt(chi_l / mpf(law.chi_ratio)) * mpmath.exp(eps) - k)
    ratio = 2 * (mpf(law.w0) / mpf(law.h0)) ** 2
    if bleed:
        micro = 2 * mpf(law.l0_over_d) ** 2 * k * gap**2
        return ratio * mpmath.exp(-2 * (eps + lock)) * micro * mpmath.exp(mpf(law.b_bleed))
    micro = 2 * mpmath.sqrt(chi_l) * mpmath.exp(eps) * k * (gap**2 + 3)
    return ratio * mpmath.exp(-4 * eps) * micro * mpmath.exp(mpf(law.b_squeeze))


def strain_integral(law: LawParameters, start: float, end: float, bleed: bool) -> Any:
    """Integral of (eta exp(b))^m over -eps from start to end; nearly all of it lies next to `end`."""
    power = 1 / (mpmath.mpf(law.a) + 1)
    start, end = mpmath.mpf(start), mpmath.mpf(end)
    points = [end + (start - end) * mpmath.mpf(2) ** -level for level in range(9)] + [end]
    return -mpmath.quad(lambda eps: printed_viscosity(law, eps, bleed) ** power, points)


def load_integral(load: LoadProgramme, power: Any, start: float, end: float) -> Any:
    """Integral of p^m over time from the antiderivative on every linear piece."""
    total = mpmath.mpf(0)
    for begin, stop, first, last in load.pieces():
        low, high = mpmath.mpf(max(begin, start)), mpmath.mpf(min(stop, end))
        if high <= low:
            continue
        slope = (mpmath.mpf(last) - first) / (mpmath.mpf(stop) - begin)
        ends = first + slope * (low - begin), first + slope * (high - begin)
        if slope == 0:
            total += (high - low) * ends[0] ** power
        else:
            total += (ends[1] ** (power + 1) - ends[0] ** (power + 1)) / (slope * (power + 1))
    return total


def strain_error(
    law: LawParameters, load: LoadProgramme, times: Sequence[float], solved: LawParameters | None = None
) -> float:
    """Largest error of eps, at the lock too: the mismatch of the two integrals, divided by d(integral)/d(-eps)."""
    mpmath.mp.dps = 25
    history = integrate(solved or law, load, times)
    power = 1 / (mpmath.mpf(law.a) + 1)
    lock_time = history.lock_time or 0.0
    ends = [(0.0, law.eps_lock, False, 0.0, lock_time)] if lock_time else []
    for time, eps, locked in zip(history.time, history.eps, history.locked, strict=True):
        ends.append((law.eps_lock if locked else 0.0, float(eps), bool(locked), lock_time if locked else 0.0, time))
    return max(end_error(law, load, power, *end) for end in ends)


def end_error(
    law: LawParameters, load: LoadProgramme, power: Any, start: float, eps: float, locked: bool, begin: float, time: float
) -> float:
    """Error of eps at a time, for one stage that starts at a compaction `start` at the time `begin`."""
    mismatch = strain_integral(law, start, eps, locked) - load_integral(load, power, begin, time)
    return abs(float(mismatch / printed_viscosity(law, mpmath.mpf(eps), locked) ** power))


HOLD = LoadProgramme((0.0, 1200.0), (0.1, 0.1))
PRESSED = LoadProgramme((0.0, 1e6), (50.0, 50.0))  # ends within 0.05 of the compaction limit


@pytest.mark.parametrize(("name", "temperature"), COLUMNS)
def test_constant_pressure_meets_the_separable_closed_form(name: str, temperature: float) -> None:
    law = published_law(name, temperature, "CP" if name == "IM7-8552" else "BP")
    assert strain_error(law, HOLD, [1e-6, 0.5, 1200.0]) < LARGEST_ERROR
    assert strain_error(law, PRESSED, [1.0, 1e3, 1e6]) < LARGEST_ERROR
    assert 0.0 < integrate(law, PRESSED, [1e6]).eps[0] - law.eps_limit < 0.05


@pytest.mark.parametrize(("name", "temperature"), [("IM7-8552", 30.0), ("IM7-8552", 70.0), ("IMA-M21", 60.0)])
@pytest.mark.parametrize("load", ["ramp-dwell", "monotonic"])
def test_the_paper_s_load_programmes_meet_the_closed_form(name: str, temperature: float, load: str) -> None:
    law = published_law(name, temperature, "CP", 30.0)
    assert strain_error(law, load_programme(load, 30.0), [0.2, 1.0, 241.0, 1200.0]) < LARGEST_ERROR


def test_a_newtonian_ply_meets_the_closed_form_and_constants_a_millionth_off_are_noticed() -> None:
    law = replace(published_law("IM7-8552", 70.0, "BP"), a=0.0, b_squeeze=-8.0, b_bleed=-24.73)
    times = [1e-3, 0.5, 3.0, 30.0, 1200.0]
    assert set(integrate(law, HOLD, times).locked) == {True, False}
    assert strain_error(law, HOLD, times) < LARGEST_ERROR
    for other in (replace(law, a=1e-6), replace(law, k=law.k * (1.0 + 1e-6))):
        assert strain_error(law, HOLD, times, other) > 1e3 * LARGEST_ERROR


@settings(max_examples=10, deadline=None, derandomize=True)
@given(
    a=st.floats(-0.96, 0.5),
    k=st.floats(0.6, 1.1),
    aspect=st.floats(5.0, 300.0),
    eps_lock=st.floats(-0.3, -1e-3),
    pressure=st.floats(1e-3, 10.0),
)
def test_any_admissible_constants_meet_the_closed_form(
    a: float, k: float, aspect: float, eps_lock: float, pressure: float
) -> None:
    law = LawParameters(aspect, 1.0, 4294.0, k, a, -15.0, -31.73, eps_lock, 0.7)
    load = LoadProgramme((0.0, 2.0, 50.0, 60.0), (0.0, pressure, pressure, 0.5 * pressure))
    assert strain_error(law, load, [0.5, 60.0]) < LARGEST_ERROR


PLANTED: dict[str, Callable[[Any, LawParameters, equations.Stage], Any]] = {
    "log_eta_ply": lambda eps, law, stage: np.log(2.0) + 2.0 * np.log(law.w0 / law.h0) - 3.99 * eps,
    "log_eta_micro": lambda eps, law, stage: (
        np.log(2.0 * law.k) - law.eps_lock + eps - 2.0 * np.log(np.expm1(eps - law.eps_limit))
    ),
}


@pytest.mark.parametrize("name", PLANTED)
def test_a_wrong_viscosity_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(equations, name, PLANTED[name])
    law = published_law("IM7-8552", 70.0)
    assert strain_error(law, LoadProgramme((0.0, 100.0), (0.1, 0.1)), [0.5, 100.0]) > 1e3 * LARGEST_ERROR


def test_a_lock_a_billionth_late_is_noticed() -> None:
    law, load = published_law("IM7-8552", 70.0), load_programme("ramp-dwell", 15.0)
    mpmath.mp.dps = 25
    lock_time = integrate(law, load).lock_time
    assert lock_time is not None
    late = end_error(law, load, 1 / (mpmath.mpf(law.a) + 1), 0.0, law.eps_lock, False, 0.0, lock_time * (1.0 + 1e-9))
    assert late > LARGEST_ERROR


def test_viscosities_follow_equations_4_and_5_in_both_stages() -> None:
    law = published_law("IMA-M21", 50.0, "SB")
    for eps in (-0.01, law.eps_lock + 1e-6, law.eps_lock, law.eps_lock - 0.05):
        wanted = float(printed_viscosity(law, mpmath.mpf(eps), eps <= law.eps_lock))
        assert -float(compaction_stress(eps, -1.0, law)) == pytest.approx(wanted, rel=1e-13)
        pressed = -float(compaction_stress(eps, -1e-3, law))  # the power of the rate
        assert pressed == pytest.approx(wanted * 1e-3 ** (law.a + 1.0), rel=1e-13)


@pytest.mark.parametrize(("name", "temperature"), COLUMNS)
def test_at_the_lock_the_ply_factor_is_continuous_and_the_stress_drops(name: str, temperature: float) -> None:
    law = published_law(name, temperature)
    before, after = law.eps_lock * (1.0 - 1e-12), law.eps_lock
    ply = [float(log_eta_ply(law.eps_lock, law, stage)) for stage in Stage]
    assert ply[0] == pytest.approx(ply[1], rel=1e-13)
    gap = law.k / (law.chi_ratio**-0.5 - law.k)
    bleed = law.l0_over_d**2 * math.exp(law.b_bleed - law.b_squeeze)
    drop = float(compaction_stress(after, -1e-3, law) / compaction_stress(before, -1e-3, law))
    assert drop == pytest.approx(bleed * gap**2 / (gap**2 + 3.0), rel=1e-9)
    assert 0.55 < drop < 0.86


def check_kinematics(law: LawParameters, history: LawHistory) -> None:
    assert history.lock_time is not None
    assert np.all(np.diff(history.thickness_ratio) <= 0.0)
    squeeze, bleed = ~history.locked, history.locked
    volume = history.thickness_ratio * history.width_ratio
    assert np.max(np.abs(volume[squeeze] - 1.0)) < 1e-14
    assert np.max(np.abs(history.width_ratio[bleed] - math.exp(-law.eps_lock))) == 0.0
    assert np.max(np.abs(history.fibre_fraction * volume - 0.5)) < 1e-14
    assert history.thickness_ratio[-1] > math.exp(law.eps_limit)


def test_the_ply_keeps_its_volume_until_it_locks_and_its_width_after() -> None:
    law = published_law("IMA-M21", 80.0, "CP", 30.0)
    history = integrate(law, load_programme("ramp-dwell", 30.0))
    check_kinematics(law, history)
    with pytest.raises(AssertionError):  # a ply that goes on widening is noticed
        check_kinematics(law, replace(history, width_ratio=np.exp(-history.eps)))
    with pytest.raises(AssertionError):  # one that loses volume before the lock, too
        check_kinematics(law, replace(history, width_ratio=np.full(601, math.exp(-law.eps_lock))))


def test_without_load_nothing_moves() -> None:
    history = integrate(published_law("IM7-8552", 70.0), LoadProgramme((0.0, 10.0), (0.0, 0.0)))
    assert np.all(history.thickness_ratio == 1.0)
    assert history.lock_time is None


def test_a_load_too_small_to_lock_leaves_the_ply_squeezing() -> None:
    law = published_law("IM7-8552", 60.0, "CP", 30.0)
    load = LoadProgramme((0.0, 10.0), (0.02, 0.02))
    history = integrate(law, load)
    assert history.lock_time is None
    assert not history.locked.any()
    assert history.eps[-1] < 0.0
    assert strain_error(law, load, [1.0, 10.0]) < LARGEST_ERROR


def test_the_lock_strain_is_the_larger_branch_of_equation_6() -> None:
    edge = -math.log(math.sqrt(2.0 / 3.0 * 0.5 / 15.0 * math.tan(math.radians(80.0)) + 1.0))
    assert lock_strain(0.5, 15.0, 80.0, -0.2258) == pytest.approx(edge, rel=1e-14)
    assert lock_strain(5.0, 15.0, 80.0, -0.2258) == pytest.approx(2.0 / 3.0 * -0.2258, rel=1e-14)
    assert bulk_lock_strain(0.5) == pytest.approx(-0.225791, abs=1e-6)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"eps_lock": 0.0}, "eps_lock = 0 must be below 0"),
        ({"eps_lock": 0.1}, "eps_lock = 0.1 must be below 0"),
        ({"a": -1.0}, "above -1"),
        ({"k": 1.3}, r"below 1/sqrt\(chi_ratio\)"),
        ({"h0": 0.0}, "h0 = 0 must be above 0"),
        ({"b_bleed": math.nan}, "b_bleed = nan must be a finite number"),
    ],
)
def test_constants_outside_their_bounds_are_refused(changed: dict[str, float], message: str) -> None:
    values = vars(published_law("IM7-8552", 70.0)) | changed
    with pytest.raises(InputError, match=message):
        LawParameters(**values)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        *((lambda law, eps=eps: compaction_stress(law.eps_limit - eps, -1e-3, law), "compaction limit") for eps in (0.0, 0.1)),
        (lambda law: compaction_stress(math.nan, -1e-3, law), "compaction limit"),
        (lambda law: compaction_stress(-0.01, 1e-3, law), "must not be above 0"),
        *((lambda law, angle=angle: lock_strain(0.5, 15.0, angle, -0.2), "gamma_lock") for angle in (-1.0, 90.0, math.nan)),
        (lambda law: integrate(law, LoadProgramme((0.0, 10.0), (0.1, 0.1)), [11.0]), "0 to 10 s"),
        (lambda law: integrate(replace(law, a=1.0), HOLD), "a = 1 must be below 1"),
    ],
)
def test_where_the_law_has_no_answer_it_is_refused(call: Callable[[LawParameters], Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        call(published_law("IM7-8552", 70.0))
