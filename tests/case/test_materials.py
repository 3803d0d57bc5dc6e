"""The paper's tables as data, their interpolation, material files and the cases made with them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator, make_interp_spline

from plyflow.case import case as cases
from plyflow.case.case import LAW_MANIFEST, Case
from plyflow.case.materials import (
    CubicPieces,
    Material,
    find_material,
    known_materials,
    monotone_cubic,
    read_material,
    temperature_table,
)
from plyflow.cli import main
from plyflow.errors import InputError

NAMES = ("k", "a", "b_squeeze", "b_bleed")
GOOD_FILE = """
name = "Test"
source = "a test"
ply_thickness = 0.2
[table]
temperature = [20.0, 40.0]
k = [0.9, 0.8]
a = [-0.9, -0.8]
b_squeeze = [-15.0, -14.0]
b_bleed = [-31.0, -30.0]
"""

OWN = GOOD_FILE.replace("Test", "IM7-8552").replace("[20.0, 40.0]", "[60.0, 70.0]")


def own_file(folder: Path, text: str = GOOD_FILE) -> str:
    path = folder / "mine.toml"
    path.write_text(text)
    return str(path)


def check_offset_of_b(material: Material) -> None:
    """b_squeeze - b_bleed is 16.73 to the last printed digit in every column, whatever the material."""
    offsets = np.subtract(material.table.b_squeeze, material.table.b_bleed)
    assert np.max(np.abs(offsets - 16.73)) < 0.0101


@pytest.mark.parametrize("name", ["IM7-8552", "IMA-M21"])
def test_b_of_both_stages_differ_by_the_same_number_in_every_column(name: str) -> None:
    check_offset_of_b(find_material(name))


def test_a_mistyped_b_is_noticed() -> None:
    material = find_material("IM7-8552")
    wrong = (*material.table.b_bleed[:-1], -31.17)
    planted = material.model_copy(update={"table": material.table.model_copy(update={"b_bleed": wrong})})
    with pytest.raises(AssertionError):
        check_offset_of_b(planted)


def test_table_columns_are_returned_as_printed() -> None:
    at_70 = find_material("IM7-8552").at(70.0)
    assert (at_70.k, at_70.a, at_70.b_squeeze, at_70.b_bleed) == (0.813, -0.866, -14.93, -31.66)
    at_60 = find_material("IMA-M21").at(60.0)
    assert (at_60.k, at_60.a, at_60.b_squeeze, at_60.b_bleed) == (0.805, -0.731, -13.9, -30.63)


def check_stays_between_columns(table: Material, values: Callable[[str, float], float]) -> None:
    columns = np.array(table.table.temperature)
    for name in NAMES:
        printed = np.array(getattr(table.table, name))
        for low, high, first, last in zip(columns, columns[1:], printed, printed[1:], strict=False):
            inside = [values(name, temperature) for temperature in np.linspace(low, high, 21)]
            assert min(first, last) - 1e-12 <= min(inside) <= max(inside) <= max(first, last) + 1e-12


@pytest.mark.parametrize("name", ["IM7-8552", "IMA-M21"])
def test_interpolation_never_leaves_the_neighbouring_columns(name: str) -> None:
    material = find_material(name)
    check_stays_between_columns(material, lambda column, at: float(getattr(material.at(at), column)))


def test_a_cubic_that_overshoots_is_noticed() -> None:
    material = find_material("IMA-M21")

    def overshooting(column: str, at: float) -> float:
        return float(make_interp_spline(material.table.temperature, getattr(material.table, column), k=3)(at))

    with pytest.raises(AssertionError):
        check_stays_between_columns(material, overshooting)


def test_interpolation_is_the_declared_monotone_cubic() -> None:
    material = find_material("IM7-8552")
    expected = float(PchipInterpolator(material.table.temperature, material.table.a)(47.3))
    assert material.at(47.3).a == pytest.approx(expected, rel=1e-15)
    linear = float(np.interp(47.3, material.table.temperature, material.table.a))
    assert abs(material.at(47.3).a - linear) > 1e-6


def test_names_are_found_whatever_their_case() -> None:
    assert find_material("ima-m21") is known_materials()["IMA-M21"]


@pytest.mark.parametrize("temperature", [29.999, 90.001, float("nan"), float("inf")])
def test_temperature_outside_the_table_is_refused_with_its_bounds(temperature: float) -> None:
    with pytest.raises(InputError, match="30 to 90"):
        find_material("IM7-8552").at(temperature)


def test_a_material_file_works_like_a_known_material(tmp_path: Path) -> None:
    material = find_material(own_file(tmp_path))
    assert material.name == "Test"
    assert material.at(40.0).k == 0.8


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("0.2", "-0.2", "ply_thickness = -0.2: input should be greater than 0"),
        ("ply_thickness = 0.2\n", "", "ply_thickness is missing: add ply_thickness = ..."),
        ("[20.0, 40.0]", "[40.0, 20.0]", "temperature 20 degC follows 40 degC: put the columns in increasing order"),
        ("k = [0.9, 0.8]", "k = [0.9]", "k has 1 value for 2 temperatures: give one for each"),
        ("a = [-0.9", "a = [-1.0", "above -1"),
        ("a = [-0.9", "a = [0.01", "a = 0.01 must be at most 0"),
        ("k = [0.9", "k = [0.0", "above 0"),
        ("b_bleed", "b_blead", r"table.b_bleed is missing"),
        ("[table]", "[tabel]", r"table is missing: add \[table\]"),
        ("[table]", "[table]\neta = [1.0, 2.0]", r"'table.eta' is not known: the keys of \[table\] are temperature, k, a, b_sq"),
        ("[0.9, 0.8]", "[nan, 0.8]", "finite"),
        ("[table]", "[table", "not valid TOML"),
    ],
)
def test_a_faulty_material_file_is_refused_by_name(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        find_material(own_file(tmp_path, GOOD_FILE.replace(old, new, 1)))
    assert "mine.toml" in str(caught.value)


def table_error(material: Material, table: dict[str, CubicPieces]) -> float:
    """Largest difference of the pieces to the monotone cubic by scipy, relative to the parameter."""
    columns, worst = material.table, 0.0
    for name, pieces in table.items():
        cubic = PchipInterpolator(columns.temperature, getattr(columns, name))
        for temperature in np.linspace(columns.temperature[0], columns.temperature[-1], 241):
            expected = float(cubic(temperature))
            worst = max(worst, abs(pieces.at(float(temperature)) / expected - 1.0))
    return worst


@pytest.mark.parametrize("name", ["IM7-8552", "IMA-M21"])
def test_the_table_s_plain_numbers_are_the_monotone_cubic(name: str) -> None:
    material = find_material(name)
    table = temperature_table(material)
    assert tuple(table) == NAMES
    assert table_error(material, table) < 1e-14
    for pieces in table.values():
        assert pieces.breakpoints == material.table.temperature
        assert all(type(number) is float for row in pieces.coefficients for number in row)
        assert type(pieces.end_slopes[0]) is float
    (c3, *rest), *others = table["a"].coefficients
    wrong = replace(table["a"], coefficients=((c3 * (1.0 + 1e-6), *rest), *others))
    assert table_error(material, table | {"a": wrong}) > 1e-12  # a coefficient off by a millionth is noticed


def test_one_temperature_is_a_constant_and_two_a_straight_line() -> None:
    one = monotone_cubic((70.0,), (0.813,))
    assert (one.at(70.0), one.at(200.0), one.breakpoints) == (0.813, 0.813, (70.0, 70.0))
    two = monotone_cubic((20.0, 40.0), (1.0, 3.0))
    assert [two.at(temperature) for temperature in (0.0, 20.0, 30.0, 40.0, 50.0)] == pytest.approx(
        [-1.0, 1.0, 2.0, 3.0, 4.0]
    )


def test_outside_the_table_only_on_request_and_then_it_is_said() -> None:
    material = find_material("IM7-8552")
    with pytest.raises(InputError, match="outside 30 to 90 degC, the range of IM7-8552: choose one inside, or ask for"):
        material.at(95.0)
    slope = (material.at(90.0).a - material.at(90.0 - 1e-5).a) / 1e-5
    assert material.at(95.0, extrapolate=True).a == pytest.approx(-0.822 + 5.0 * slope, abs=1e-6)
    assert material.at(50.0, extrapolate=True) == material.at(50.0)
    assert material.source_of(95.0).startswith("extrapolated as asked")
    assert material.source_of(47.0) == "monotone cubic (PCHIP) between the temperature columns, 30 to 90 degC"
    assert material.source_of(50.0).startswith("column 50 degC of the table")
    with pytest.raises(InputError, match=r"extrapolates to k = .*stay closer to 30 to 90 degC"):
        material.at(1e4, extrapolate=True)
    with pytest.raises(InputError, match="nan"):
        material.at(float("nan"), extrapolate=True)


def test_a_file_need_not_state_its_source_and_may_have_a_newtonian_resin(tmp_path: Path) -> None:
    text = GOOD_FILE.replace('source = "a test"\n', "").replace("a = [-0.9, -0.8]", "a = [-0.9, 0.0]")
    material = find_material(own_file(tmp_path, text))
    assert material.source == "not stated"
    assert material.at(40.0).a == pytest.approx(0.0, abs=1e-12)


def test_a_mistyped_material_gets_the_nearest_name() -> None:
    with pytest.raises(InputError, match=r"unknown material 'IM7-855', did you mean IM7-8552\? Known are IM7-8552, IMA"):
        find_material("IM7-855")
    with pytest.raises(InputError, match="unknown material 'steel': known are IM7-8552, IMA-M21"):
        find_material("steel")
    with pytest.raises(InputError, match=r"absent\.toml cannot be read"):
        find_material("absent.toml")


def check_own_numbers(path: str) -> None:
    values = cases.property_values(Case(path, 70.0, "CP", 15.0), LAW_MANIFEST)
    assert (values["k"], values["h0"]) == (0.8, 0.2)


def test_a_file_keeps_its_numbers_even_under_the_name_of_a_known_material(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = own_file(tmp_path, OWN)
    check_own_numbers(path)
    assert Case("im7-8552", 70.0, "CP", 15.0).material == "IM7-8552"

    def by_name(name: str) -> Material:
        return known_materials()[find_material(name).name]

    monkeypatch.setattr(cases, "find_material", by_name)  # the paper's table in place of the file is noticed
    with pytest.raises(AssertionError):
        check_own_numbers(path)


def test_a_case_outside_the_table_runs_on_request_only_and_says_so(tmp_path: Path) -> None:
    path = own_file(tmp_path, OWN)
    with pytest.raises(InputError, match=r"temperature 75 degC is outside 60 to 70 degC, .* --extrapolate"):
        Case(path, 75.0, "CP", 15.0)
    case = Case(path, 75.0, "CP", 15.0, extrapolate=True)
    values = cases.property_values(case, LAW_MANIFEST)
    assert values["a"] == pytest.approx(-0.75, rel=1e-14)  # two columns make a straight line
    assert Case(path, 75.0, "CP", 15.0, extrapolate=True).law().a == values["a"]
    assert any("extrapolated as asked" in line for line in cases.assumption_lines(case, values))


def test_run_and_law1d_extrapolate_on_request(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = ("--material", own_file(tmp_path, OWN), "--temperature", "75", "--layup", "CP", "--json")
    for command in ("run", "law1d"):
        assert main([command, *case]) == 2
        assert capsys.readouterr().err.count("\n") == 1
        assert main([command, *case, "--extrapolate"]) == 0
        found = json.loads(capsys.readouterr().out)
        lines = found["assumptions"] if isinstance(found, dict) else found[0]["assumptions"]
        assert any("extrapolated as asked" in line for line in lines)


def test_a_shipped_material_is_written_to_edit_and_never_over_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.toml"
    assert main(["material", "im7-8552", "-o", str(file)]) == 0
    assert read_material(file) == find_material("IM7-8552")
    for where, what in ((file, "is there already"), (tmp_path / "mine.txt", "a material file is called NAME.toml")):
        assert main(["material", "IMA-M21", "-o", str(where)]) == 2
        assert what in capsys.readouterr().err
    assert main(["material", "IMA-M21", "-o", str(file), "--force"]) == 0
    assert read_material(file).name == "IMA-M21"
    assert main(["material", str(file)]) == 0
    assert 'name = "IMA-M21"' in capsys.readouterr().out
