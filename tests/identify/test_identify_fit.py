"""Choices of the fit: the tie of b, specimens together or apart, noise too large for lines, the k-a-b valley."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from identify.making import BOTH_LOADS, RAMP_DWELL, read_back, synthetic, truth
from plyflow.case.case import Case
from plyflow.errors import InputError, RunError
from plyflow.identify import refine, start, valley
from plyflow.identify.model import NAMES, residuals
from plyflow.identify.refine import Fit, fit
from plyflow.identify.report import assumption_lines, material_text
from plyflow.identify.specimen import Specimen, read_specimen
from plyflow.identify.start import TIE_ROUNDING
from plyflow.identify.valley import Plane, planes, refined, region_level
from plyflow.law import LoadProgramme
from plyflow.run.synthetic import synthetic_test

OFFSET = 2.0 * math.log(4294.0)


def noisy(folder: Path, column: tuple[str, float], tests: list[tuple[str, float, str]]) -> list[Specimen]:
    pure = [synthetic(*column, test) for test in tests]
    return read_back([test.with_noise(0.005, 0.1, seed) for seed, test in enumerate(pure)], folder)


def test_b_is_tied_where_the_specimen_locks_before_the_readings_tell(tmp_path: Path) -> None:
    found = fit(noisy(tmp_path, ("IM7-8552", 30.0), RAMP_DWELL))
    assert found.tied
    squeeze, bleed = found.estimates["b_squeeze"], found.estimates["b_bleed"]
    assert squeeze.value - bleed.value == pytest.approx(OFFSET, rel=1e-12)
    assert bleed.low - squeeze.low + OFFSET == pytest.approx(TIE_ROUNDING)  # the tie is known to 0.01 only


def test_b_is_fitted_where_readings_lie_before_the_lock_and_on_request(tmp_path: Path) -> None:
    specimens = noisy(tmp_path, ("IM7-8552", 70.0), BOTH_LOADS)
    loose = fit(specimens)
    assert not loose.tied
    assert any("intervals come out too narrow" in line for line in assumption_lines(loose))
    tied = fit(specimens, "always")
    assert tied.tied
    assert not any("too narrow" in line for line in assumption_lines(tied))
    free, asked = loose.estimates["b_squeeze"], fit(specimens, "never").estimates["b_squeeze"]
    assert asked.value == pytest.approx(free.value, abs=0.3 * free.error)


def test_a_broken_tie_is_found_by_the_readings(tmp_path: Path) -> None:
    """A material whose b_squeeze is 0.3 off the tie: the readings win over the assumption."""
    case = Case("IM7-8552", 70.0, "CP", 15.0, settings={"b_squeeze": -14.63})
    tests = [synthetic_test(replace(case, load=load)) for load in ("ramp-dwell", "monotonic")]
    found = fit(read_back(tests, tmp_path))
    assert found.estimates["b_squeeze"].value == pytest.approx(-14.63, abs=1e-4)
    assert found.estimates["b_bleed"].value == pytest.approx(-31.66, abs=1e-4)


def test_more_specimens_narrow_the_intervals(tmp_path: Path) -> None:
    specimens = noisy(tmp_path, ("IMA-M21", 70.0), RAMP_DWELL)
    together = fit(specimens, "always")
    for one in specimens:
        apart = fit([one], "always")
        for name in ("k", "a", "b_bleed"):
            assert together.estimates[name].error < apart.estimates[name].error


def test_readings_too_noisy_for_lines_are_fitted_from_a_coarse_search(tmp_path: Path) -> None:
    blocked = [("BP", 15.0, "ramp-dwell")]
    found = fit(noisy(tmp_path, ("IM7-8552", 30.0), blocked))
    assert found.lines is None
    assert "coarse search" in found.notes[0]
    assert found.estimates["k"].value == pytest.approx(0.933, abs=3e-3)


def check_optimum(found: Fit) -> None:
    """A twentieth of a standard error either way is not better by more than a fiftieth of the readings' variance."""
    least = float(np.sum(residuals(found.specimens, found.values[None]) ** 2)) - 0.02 * found.scatter**2
    for place, name in enumerate(NAMES):
        for side in (-1.0, 1.0):
            moved = found.values.copy()
            moved[place] += side * 0.05 * found.estimates[name].error
            assert float(np.sum(residuals(found.specimens, moved[None]) ** 2)) > least


def test_the_fit_is_the_least_squares_optimum(tmp_path: Path) -> None:
    found = fit(noisy(tmp_path, ("IM7-8552", 70.0), BOTH_LOADS))
    check_optimum(found)
    estimates = found.estimates | {"k": replace(found.estimates["k"], value=found.estimates["k"].value + 1e-3)}
    with pytest.raises(AssertionError):  # a k off by 0.001 is noticed
        check_optimum(replace(found, estimates=estimates))


def check_plane(found: Fit, plane: Plane) -> None:
    """The least misfit is at the fit, and the 95 % region is about as wide as the covariance says."""
    where = np.unravel_index(np.argmin(plane.misfit), plane.misfit.shape)
    assert plane.misfit[where] < 1e-9
    level = region_level(found)
    for values, axis, name in ((plane.first_values, 0, plane.first), (plane.second_values, 1, plane.second)):
        inside = plane.misfit.min(axis=axis) < 12.0 * level  # the region of 95 % is finer than the grid
        half = 0.5 * (values[inside].max() - values[inside].min())
        assert half == pytest.approx(12.0 * 2.447 * found.estimates[name].error, rel=0.35), name


def region_area(plane: Plane, level: float) -> float:
    """Area of the filled region of the picture."""
    fine = refined(plane)
    cell = (fine.first_values[1] - fine.first_values[0]) * (fine.second_values[1] - fine.second_values[0])
    return float(np.count_nonzero(fine.misfit < level) * cell)


def test_the_filled_region_of_the_picture_is_the_ellipse_of_the_covariance(tmp_path: Path) -> None:
    found = fit(noisy(tmp_path, ("IM7-8552", 70.0), RAMP_DWELL), "always")
    level = region_level(found)
    for plane in planes(found):
        chosen = [valley.TIED.index(name) for name in (plane.first, plane.second)]
        block = found.covariance[np.ix_(chosen, chosen)]
        ellipse = math.pi * float(chi2.ppf(0.95, 2)) * math.sqrt(float(np.linalg.det(block)))
        assert region_area(plane, level) == pytest.approx(ellipse, rel=0.15), (plane.first, plane.second)
        assert region_area(plane, 1.2 * level) != pytest.approx(ellipse, rel=0.15)  # a region too wide is noticed


def test_the_valley_of_k_a_and_b_agrees_with_the_covariance(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(valley, "REACH", 45.0)
    found = fit(noisy(tmp_path, ("IMA-M21", 60.0), RAMP_DWELL), "always")
    for plane in planes(found):
        check_plane(found, plane)
    monkeypatch.setattr(valley, "STEPS", 0)  # without the third parameter at its best the region is noticed as wrong
    monkeypatch.setattr(valley, "_inside", lambda name, values: np.full_like(values, 0.8) if name == "k" else values)
    with pytest.raises(AssertionError):
        check_plane(found, planes(found)[2])


def test_specimens_that_do_not_belong_together_are_refused(tmp_path: Path) -> None:
    (cold,) = read_back([synthetic("IM7-8552", 30.0, RAMP_DWELL[0])], tmp_path)
    (warm,) = read_back([synthetic("IM7-8552", 70.0, RAMP_DWELL[0])], tmp_path)
    (other,) = read_back([synthetic("IMA-M21", 30.0, RAMP_DWELL[0])], tmp_path)
    with pytest.raises(InputError, match="specimens of 30, 70 degC cannot be fitted together"):
        fit([cold, warm])
    with pytest.raises(InputError, match="no specimens"):
        fit([])
    with pytest.raises(InputError, match="unknown --tie 'maybe'"):
        fit([cold], "maybe")
    one, two = fit([cold]), fit([other])
    with pytest.raises(InputError, match="two fits of one temperature"):
        material_text("x", [one, one])
    with pytest.raises(InputError, match=r"plies of 0\.125, 0\.165 mm are not one material"):
        material_text("x", [one, fit([read_back([synthetic("IMA-M21", 70.0, RAMP_DWELL[0])], tmp_path)[0]])])
    assert two.estimates["k"].value == pytest.approx(truth("IMA-M21", 30.0)["k"], abs=1e-6)


def made_up(folder: Path, thickness: Callable[[np.ndarray], np.ndarray], every: float = 1.0) -> Specimen:
    """Forty readings of a BP specimen of 2 mm under 20 N that owe nothing to the law."""
    time = every * np.arange(40.0)
    head = "# layup: BP\n# width: 15\n# ply thickness: 0.125\n# temperature: 70\ntime,force,thickness\n"
    rows = [f"{t:g},20,{h:.6g}" for t, h in zip(time, thickness(time), strict=True)]
    path = folder / "made_up.csv"
    path.write_text(head + "\n".join(rows) + "\n")
    return read_specimen(path, {}, {})


def test_a_fit_that_creeps_to_the_last_trial_ends_with_its_best(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A specimen that never leaves the squeeze stage starts inside the law's bounds, and too few trials are no error."""
    monkeypatch.setattr(refine, "MOST_TRIALS", 6)
    found = fit([made_up(tmp_path, lambda time: 2.0 - 0.02 * np.log1p(time), 20.0)], "always")
    assert found.estimates["k"].value < 1.0 / math.sqrt(0.7)
    assert all(math.isfinite(number) for one in found.estimates.values() for number in vars(one).values())


def test_readings_no_law_comes_near_are_refused_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (specimen,) = read_back([synthetic("IM7-8552", 70.0, RAMP_DWELL[0])], tmp_path)

    def nothing(*_: object) -> np.ndarray:
        raise RunError("the one-dimensional law cannot be followed")

    with monkeypatch.context() as patched:
        patched.setattr(start, "coarse_start", nothing)
        with pytest.raises(
            RunError, match=r"test0: no parameters of the law come near these readings .*followed.*units"
        ):
            fit([specimen])
    steps = replace(
        specimen, load=LoadProgramme((0.0, *range(1, 1201)), tuple(0.1 * (place % 2) for place in range(1201)))
    )
    with pytest.raises(
        InputError, match="test0: only 1 readings follow a load that changed by less than 5% of its peak"
    ):
        fit([steps])
