"""Files as instruments and people write them: what is read, and every complaint with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from plyflow.case.loads import find_load, read_load
from plyflow.case.measured_file import MeasuredFile, read_measured
from plyflow.case.quantities import find_quantity, split_heading
from plyflow.errors import InputError

NEEDED = ("time", "force", "thickness")
PLAIN = "time [s],force [N],thickness [mm]\n0,0,2\n1,20,1.9\n2.5,20,1.85\n"
SAME: dict[str, str] = {
    "comments and empty lines": "# layup: BP\n\n" + PLAIN.replace("1,20", "% noise\n1,20"),
    "units in brackets and others": "Time (min);Load (kN);gap (µm)\n0;0;2000\n0.0166666666666666667;0.02;1900\n"
    "0.0416666666666666667;0.02;1850\n",
    "decimal commas": "Zeit [s];Kraft [N];Dicke [mm]\n0;0;2\n1;20,0;1,9\n2,5;20;1,85\n",
    "quoted decimal commas": 'time [s],force [N],thickness [mm]\n0,0,2\n1,"20,0","1,9"\n"2,5",20,"1,85"\n',
    "tabs and a row of units": "time\tforce\tthickness\ns\tN\tmm\n0\t0\t2\n1\t20\t1.9\n2.5\t20\t1.85\n",
    "blanks": "time [s]   force [N]  thickness [mm]\n0 0 2\n1 20 1.9\n2.5   20   1.85\n",
    "units after a stroke or underscore": "time / s,force_N,h / mm\n0,0,2\n1,20,1.9\n2.5,20,1.85\n",
    "other columns and order": "# not used: no, remark\n"
    "no,thickness [mm],time [s],remark,force [N]\n1,2,0,a,0\n2,1.9,1,b,20\n3,1.85,2.5,,20\n",
    "byte order mark and Windows line ends": "\ufeff" + PLAIN.replace("\n", "\r\n"),
    "a comma at each line's end": PLAIN.replace("\n", ",\n"),
}


def write(folder: Path, text: str) -> Path:
    path = folder / "test.csv"
    path.write_bytes(text.encode("utf-8"))
    return path


def check_values(measured: MeasuredFile) -> None:
    np.testing.assert_allclose(measured.columns["time"], [0.0, 1.0, 2.5], rtol=1e-12)
    np.testing.assert_allclose(measured.columns["force"], [0.0, 20.0, 20.0], rtol=1e-12)
    np.testing.assert_allclose(measured.columns["thickness"], [2.0, 1.9, 1.85], rtol=1e-12)


@pytest.mark.parametrize("kind", SAME)
def test_the_same_readings_are_read_however_they_are_written(kind: str, tmp_path: Path) -> None:
    check_values(read_measured(write(tmp_path, SAME[kind]), NEEDED))


def test_a_unit_taken_wrongly_is_noticed(tmp_path: Path) -> None:
    with pytest.raises(AssertionError):
        check_values(read_measured(write(tmp_path, PLAIN.replace("[mm]", "[cm]")), NEEDED))


def test_other_encodings_are_read(tmp_path: Path) -> None:
    path = tmp_path / "old.csv"
    path.write_bytes("time;force;\u00e9paisseur (\u00b5m)\n0;0;2000\n1;20;1900\n2,5;20;1850\n".encode("cp1252"))
    check_values(read_measured(path, NEEDED))


def test_entries_of_comments_are_kept_with_their_line_and_missing_units_are_noted(tmp_path: Path) -> None:
    measured = read_measured(
        write(tmp_path, "# ply thickness = 0.125 mm\n#layup: BP\ntime,force,h\n0,0,2\n1,1,1.9"), NEEDED
    )
    assert measured.entries == {"ply_thickness": ("0.125 mm", 1), "layup": ("BP", 2)}
    units = {"time": "s", "force": "N", "thickness": "mm"}
    assert measured.notes == [f"{name} without a unit in {measured.path} read as {units[name]}" for name in units]
    assert measured.lines.tolist() == [4, 5]


COMPLAINTS: list[tuple[str, str]] = [
    ("", r"needs a heading line and rows of numbers; found 0 lines besides comments"),
    ("time [s],force [N],thickness [mm]\n", "found 1 line besides"),
    ("time\tforce\th\ns\tN\tmm\n", "line 2: no numbers follow"),
    (PLAIN.replace("force [N]", "torque"), r"line 1: no column 'force \[N\]'; the heading has 'time \[s\]', 'torque'"),
    ("#a\n" + PLAIN.replace("[N]", "[stone]"), "line 2: unknown unit 'stone' of force: use one of n, kn"),
    (PLAIN.replace("time [s]", "force"), "line 1: two columns hold the force"),
    (PLAIN.replace("[N]", "[mm]"), "line 1: unknown unit 'mm' of force: use one of n, kn"),
    (PLAIN.replace("1,20,1.9", "1,,1.9"), "line 3: no value of force"),
    (PLAIN.replace("1,20,1.9", "1,20"), "line 3: no value of thickness"),
    (PLAIN.replace("1,20,1.9", "1,many,1.9"), "line 3: force 'many' is not a number"),
    (PLAIN.replace("1,20,1.9", "1,20,nan"), "line 3: thickness 'nan' is not a finite number"),
    (PLAIN.replace("1,20,1.9", "1,20,1,9"), "line 3: 4 values for 3 columns: with decimal commas divide"),
    ("# c\n\n" + PLAIN.replace("2.5,", "1,"), "line 6: time 1 s does not follow 1 s: times must increase"),
    (PLAIN.replace("2.5,", "0.5,"), "line 4: time 0.5 s does not follow 1 s"),
    (PLAIN.replace("1,20,1.9", "1,1.000.000,1.9"), "line 3: force '1.000.000' is not a number"),
]


@pytest.mark.parametrize(("text", "message"), COMPLAINTS)
def test_complaints_name_the_file_and_the_line(text: str, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path, NEEDED)
    assert str(path) in str(caught.value)


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_measured(tmp_path / "none.csv", NEEDED)


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("Force [kN]", "force", "kN"),
        ("plate force / N", "force", "N"),
        ("thickness_um", "thickness", "um"),
        ("t", "time", None),
    ],
)
def test_headings_are_understood(heading: str, name: str, unit: str | None) -> None:
    found, found_unit = split_heading(heading)
    quantity = find_quantity(found)
    assert quantity is not None
    assert (quantity.name, found_unit) == (name, unit)
    assert find_quantity("T", "degC") == find_quantity("temperature") != find_quantity("T")
    assert find_quantity("torque") is None


def test_a_load_file_of_force_or_pressure_becomes_a_load_programme(tmp_path: Path) -> None:
    force = read_load(write(tmp_path, "time [s];force [N]\n1;22,5\n10;45\n"), 15.0)
    assert force.times == (0.0, 1.0, 10.0)
    assert force.pressures == pytest.approx((0.0, 0.1, 0.2))
    noisy = read_load(write(tmp_path, "time,force\n0,-0.1\n1,45\n2,-0.1\n"), 15.0)
    assert noisy.pressures == pytest.approx((0.0, 0.2, 0.0))
    pressure = find_load(str(write(tmp_path, "time,pressure [bar]\n0,1\n10,2\n")), 15.0)
    assert pressure.pressures == pytest.approx((0.1, 0.2))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,force\n0,0\n1,-2\n", "line 3: force -2 N is below 0 N, a twentieth"),
        ("time,force\n-1,0\n1,2\n", "line 2: time -1 s is below 0"),
        ("time,torque\n0,0\n1,2\n", "column 'torque' is not used here, time, force, pressure, temperature, thickness, width are"),
        ("time,force,pressure\n0,0,0\n1,2,1\n", "found 2"),
    ],
)
def test_files_that_are_no_load_are_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read_load(write(tmp_path, text), 15.0)


def test_an_unknown_load_is_refused() -> None:
    with pytest.raises(InputError, match="unknown load 'sudden': choose one of ramp-dwell, monotonic, or give a file"):
        find_load("sudden", 15.0)


def test_units_that_differ_in_case_only_are_told_apart(tmp_path: Path) -> None:
    for unit, factor in (("N", 1.0), ("kN", 1e3), ("KN", 1e3), ("mN", 1e-3), ("MN", 1e6)):
        measured = read_measured(write(tmp_path, f"time [s],force [{unit}]\n0,1\n1,2\n"), ["time", "force"])
        assert measured.columns["force"].tolist() == pytest.approx([factor, 2.0 * factor]), unit
    for unit, factor in (("MPa", 1.0), ("mpa", 1.0), ("mPa", 1e-9), ("kPa", 1e-3)):
        measured = read_measured(write(tmp_path, f"time [s],pressure [{unit}]\n0,1\n1,2\n"), ["time", "pressure"])
        assert measured.columns["pressure"].tolist() == pytest.approx([factor, 2.0 * factor]), unit
