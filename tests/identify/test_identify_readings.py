"""From files to specimens: geometry, complaints with their line, the load behind a noisy force, creep rates."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from identify.making import read_back, synthetic
from plyflow.case.case import Case
from plyflow.errors import InputError
from plyflow.identify import rates
from plyflow.identify.force import noise_of, smoothed_force, steady_stretches
from plyflow.identify.rates import creep_points
from plyflow.identify.specimen import read_specimen
from plyflow.law import compaction_stress

HEAD = "# layup: BP\n# width: 15 mm\n# ply thickness: 0.125 mm\n# temperature: 70 degC\ntime [s],force [N],thickness [mm]\n"
BODY = [f"{time},20,{2.0 - 0.1 * time / 30.0:.4f}" for time in range(1, 31)]


def write(folder: Path, lines: list[str], head: str = HEAD) -> Path:
    path = folder / "bp.csv"
    path.write_text(head + "0,0,2\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_geometry_comes_from_the_file_and_options_win(tmp_path: Path) -> None:
    path = write(tmp_path, BODY)
    specimen = read_specimen(path, {}, {})
    assert (specimen.geometry.h0, specimen.geometry.stack, specimen.geometry.width) == (0.5, 2.0, 15.0)
    assert specimen.pressure[-1] == pytest.approx(20.0 / 225.0)
    assert specimen.eps_lock(0.813) == pytest.approx(Case("IM7-8552", 70.0, "BP", 15.0).law().eps_lock, rel=1e-12)
    other = read_specimen(path, {"layup": "CP", "width": 30.0, "plies": 17}, {"gamma_lock": 70.0})
    assert (other.geometry.h0, other.geometry.stack, other.geometry.width) == (0.125, 2.125, 30.0)
    assert read_specimen(write(tmp_path, BODY, HEAD.replace("BP", "4")), {}, {}).geometry == specimen.geometry
    assert read_specimen(write(tmp_path, BODY, HEAD.replace("15 mm", "1,5cm")), {}, {}).geometry == specimen.geometry
    micrometres = write(tmp_path, BODY, HEAD.replace("0.125 mm", "125 um").replace("layup: BP", "plies per block = 4"))
    assert read_specimen(micrometres, {}, {}).geometry == specimen.geometry


COMPLAINTS: list[tuple[str, list[str], str]] = [
    (HEAD.replace("# layup: BP\n", ""), BODY, r"no layup given: write '# layup: CP' into the file or give --layup"),
    (HEAD.replace("BP", "QI"), BODY, "layup 'QI' is not known"),
    (
        HEAD.replace("# width: 15 mm\n", ""),
        BODY,
        "no width given: write '# width: VALUE' into the file or give --width",
    ),
    (HEAD.replace("15 mm", "wide"), BODY, "line 2: width 'wide' is not a number"),
    (HEAD.replace("15 mm", "15 stone"), BODY, "line 2: unknown unit 'stone' of width: use mm, um"),
    (HEAD.replace("70 degC", "343 R"), BODY, "line 4: unknown unit 'R' of temperature: use degc"),
    (HEAD.replace("70 degC", "343"), BODY, r"temperature 343 degC is outside .* is it in K\? 343 K are 69.85 degC"),
    (HEAD.replace("15 mm", "0 mm"), BODY, "width = 0 must be a finite number above 0"),
    (HEAD, BODY[:10], "line 16: the file ends after 11 readings: at least 20 are needed"),
    (HEAD, [line.replace(",20,", ",-20,") for line in BODY], "line 6: no reading of force is above 0"),
    (
        HEAD,
        [*BODY, "31,-3,1.9"],
        "line 37: force -3 N is below -1 N, a twentieth of the largest: the law describes compaction; is the sign",
    ),
    (HEAD, [*BODY, "31,20,0.9"], r"line 37: thickness 0.9 mm is outside 0\.94\d+ to 2\.1 mm"),
    (HEAD, [*BODY, "31,20,2.2"], "line 37: thickness 2.2 mm is outside"),
    (HEAD, [f"{time},20,1900" for time in range(1, 31)], "line 7: thickness 1900 mm is outside"),
    (
        HEAD,
        [f"{time},20,2" for time in range(1, 31)],
        "line 36: the thickness ends at 2 mm, and 16 plies of 0.125 mm are 2",
    ),
    (HEAD, [*BODY, "30,20,1.9"], "line 37: time 30 s does not follow 30 s"),
    (HEAD.replace("thickness", "torque"), BODY, r"line 5: no column 'thickness \[mm\]'"),
]


@pytest.mark.parametrize(("head", "lines", "message"), COMPLAINTS)
def test_faulty_files_are_refused_with_their_line(head: str, lines: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read_specimen(write(tmp_path, lines, head), {}, {})


def steps_and_ramp() -> tuple[np.ndarray, np.ndarray]:
    time = np.arange(600.0)
    return time, np.where(
        time < 1, 0.0, np.where(time < 200, 20.0, np.where(time < 400, 30.0, 30.0 + 0.05 * (time - 400)))
    )


def smoothing_error(noise: float) -> float:
    """Root-mean-square error of the smoothed force [N], at most a handful of readings next to jumps left out."""
    time, force = steps_and_ramp()
    noisy = force + noise * np.random.default_rng(4).standard_normal(time.size)
    error = np.abs(smoothed_force(time, noisy) - force)
    assert np.sum(error > 0.5 * noise) <= 4
    return float(np.sqrt(np.mean(np.sort(error)[:-4] ** 2)))


def test_the_load_behind_a_noisy_force_is_found() -> None:
    assert smoothing_error(0.1) < 0.02
    time, force = steps_and_ramp()
    assert np.array_equal(smoothed_force(time, force), force)  # without noise nothing is touched
    assert noise_of(force + 0.1 * np.random.default_rng(1).standard_normal(600)) == pytest.approx(0.1, rel=0.15)


def test_steady_stretches_are_the_held_levels() -> None:
    _, force = steps_and_ramp()
    assert [stretch for stretch in steady_stretches(force) if stretch[1] <= 400] == [(1, 200)]
    assert steady_stretches(force)[1][0] == 200


def rate_error(folder: Path, temperature: float) -> float:
    """Largest error of ln(rate) from readings without noise over what is stated for it and a hundredth."""
    (specimen,) = read_back([synthetic("IMA-M21", temperature, ("BP", 15.0, "ramp-dwell"))], folder)
    law = Case("IMA-M21", temperature, "BP", 15.0).law()
    points = creep_points(specimen)
    assert points.size > 30
    error = law.rate_exponent * np.log(-compaction_stress(points.eps, -points.rate, law) / points.pressure)
    return float(np.max(np.abs(error) / (points.log_rate_error + 0.01)))


@pytest.mark.parametrize("temperature", [30.0, 50.0, 90.0])
def test_rates_from_readings_are_those_of_the_law(
    temperature: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert rate_error(tmp_path, temperature) < 3.0
    right = rates._line

    def wrong(elapsed: np.ndarray, eps: np.ndarray) -> tuple[float, float, float, float]:
        middle, rate, *errors = right(elapsed, eps)
        return middle, 1.1 * rate, errors[0], errors[1]

    monkeypatch.setattr(rates, "_line", wrong)  # rates a tenth too fast are noticed
    assert temperature != 50.0 or rate_error(tmp_path, temperature) > 3.0
