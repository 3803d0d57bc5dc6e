"""From a case to PROPS, driver steps and declared assumptions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from plyflow.case.assumptions import default_assumptions
from plyflow.case.case import (
    Case,
    all_cases,
    assumption_lines,
    driver_steps,
    law_parameters,
    property_values,
    props_vector,
    setting_names,
)
from plyflow.errors import InputError
from plyflow.law import bulk_lock_strain, edge_shear, lock_strain

PROPS_ORDER = (
    *("w0", "h0", "l0_over_d", "k", "a", "b_squeeze", "b_bleed", "eps_lock", "chi_ratio"),
    *("E_L", "E_T", "nu_LT", "nu_TT", "G_LT", "kappa", "rate_floor", "strain_floor"),
)
EXAMPLE = Case("im7-8552", 70.0, "bp", 15.0)


def values_with(manifest: dict[str, Any], **settings: float) -> dict[str, float]:
    return property_values(replace(EXAMPLE, settings=settings), manifest)


def test_the_programme_has_84_different_cases() -> None:
    cases = all_cases()
    assert len(cases) == len({case.label for case in cases}) == 84
    assert {case.layup for case in cases} == {"CP", "SB", "BP"}
    assert {case.width for case in cases} == {15.0, 30.0}


def test_names_are_taken_in_their_usual_spelling() -> None:
    assert EXAMPLE.label == "IM7-8552 70 degC BP 15 mm ramp-dwell"


@pytest.mark.parametrize(("layup", "plies"), [("CP", 1), ("SB", 2), ("BP", 4)])
@pytest.mark.parametrize(("name", "ply"), [("IM7-8552", 0.125), ("IMA-M21", 0.165)])
def test_equal_plies_act_as_one_ply_of_their_total_thickness(
    layup: str, plies: int, name: str, ply: float, manifest: dict[str, Any]
) -> None:
    values = property_values(Case(name, 50.0, layup, 30.0), manifest)
    assert values["h0"] == pytest.approx(plies * ply, rel=1e-15)
    assert values["eps_lock"] == lock_strain(plies * ply, 30.0, edge_shear(values["k"], 0.5), bulk_lock_strain(0.5))


def test_props_follow_the_order_of_the_manifest(manifest: dict[str, Any]) -> None:
    values = property_values(EXAMPLE, manifest)
    props = dict(zip(PROPS_ORDER, props_vector(values, manifest), strict=True))
    assert props["w0"] == 15.0
    assert props["h0"] == 0.5
    assert (props["k"], props["a"], props["b_squeeze"], props["b_bleed"]) == (0.813, -0.866, -14.93, -31.66)
    assert (props["E_L"], props["E_T"], props["G_LT"]) == (25.0, 1e-6, 0.495e-6)
    defaults = {entry["name"]: entry["default"] for entry in manifest["props"]}
    for name in ("kappa", "rate_floor", "strain_floor"):
        assert props[name] == defaults[name]


def test_a_manifest_in_another_order_gives_props_in_that_order(manifest: dict[str, Any]) -> None:
    turned = dict(manifest, props=[dict(entry, index=18 - entry["index"]) for entry in manifest["props"]])
    values = property_values(EXAMPLE, manifest)
    assert props_vector(values, turned) == props_vector(values, manifest)[::-1]


def test_settings_replace_assumptions_props_and_what_follows_from_them(manifest: dict[str, Any]) -> None:
    values = values_with(manifest, gamma_lock=60.0, kappa=77.0, k=0.7)
    assert values["kappa"] == 77.0
    assert law_parameters(values).k == 0.7
    assert values["eps_lock"] == lock_strain(0.5, 15.0, 60.0, bulk_lock_strain(0.5))
    assert values_with(manifest, k=0.7)["eps_lock"] == lock_strain(0.5, 15.0, edge_shear(0.7, 0.5), bulk_lock_strain(0.5))
    assert values_with(manifest, gamma_lock=60.0, eps_lock=-0.02)["eps_lock"] == -0.02
    assert values_with(manifest, eps_lock_bulk=-0.03)["eps_lock"] == pytest.approx(-0.02, rel=1e-14)


def test_steps_hold_the_fibre_free_the_edge_and_press_with_the_plate() -> None:
    steps = driver_steps(EXAMPLE.load_programme)
    assert [step.duration for step in steps] == pytest.approx([1.0, 239.0] * 5)
    assert [step.targets["33"] * 225.0 for step in steps] == pytest.approx(
        [20.0, 20.0, 30.0, 30.0, 40.0, 40.0, 50.0, 50.0, 60.0, 60.0]
    )
    for step in steps:
        assert {name: step.kinds[name] for name in ("11", "22", "33")} == {"11": "F", "22": "S", "33": "P"}
        assert {step.targets[shear] for shear in ("12", "13", "23")} == {0.0}
        assert (step.targets["11"], step.targets["22"]) == (1.0, 0.0)


def check_declared(lines: list[str], values: dict[str, float]) -> None:
    """Every assumed value is named with the value the run really uses."""
    for name in default_assumptions():
        used = values.get(name)
        line = next((line for line in lines if line.startswith(f"{name} = ")), "")
        assert line, name
        if used is not None:
            assert float(line.split("=")[1].split(":")[0].split()[0]) == pytest.approx(used, rel=1e-5)


def test_every_assumption_is_printed_with_the_value_in_use(manifest: dict[str, Any]) -> None:
    case = replace(EXAMPLE, settings={"l0_over_d": 3000.0})
    values = property_values(case, manifest)
    lines = assumption_lines(case, values)
    check_declared(lines, values)
    assert any(line.startswith("l0_over_d = 3000") and line.endswith("set for this run") for line in lines)
    assert any(line.startswith("gamma_lock = 86.074 deg") and line.endswith("k = 0.813 and V0 = 0.5") for line in lines)
    given = replace(EXAMPLE, settings={"gamma_lock": 80.0})
    assert any(line.startswith("gamma_lock = 80 deg") and line.endswith("set for this run") for line in given.law_assumptions())
    locked = replace(EXAMPLE, settings={"eps_lock": -0.1})
    assert any(line.startswith("gamma_lock") and line.endswith("eps_lock is set") for line in locked.law_assumptions())
    with pytest.raises(AssertionError):  # a forgotten line is noticed
        check_declared([line for line in lines if "chi_ratio" not in line], values)
    with pytest.raises(AssertionError):  # a line with another value than the run's, too
        check_declared(lines, values | {"l0_over_d": 4294.0})


def test_a_width_outside_the_paper_says_where_its_forces_come_from(manifest: dict[str, Any]) -> None:
    case = replace(EXAMPLE, width=20.0)
    text = " ".join(assumption_lines(case, property_values(case, manifest)))
    assert "the paper has no 20 mm specimen" in text


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"material": "X"}, "unknown material 'X'"),
        ({"temperature": 95.0}, "30 to 90"),
        ({"layup": "XP"}, "unknown layup 'XP'"),
        *(({"width": width}, f"width {width:g} mm") for width in (0.0, -3.0, float("nan"))),
        ({"load": "sudden"}, "unknown load 'sudden'"),
        ({"plies": 0}, "plies = 0 must be at least 1"),
        ({"plies": 6}, "6 plies are no whole number of blocks of 4; give a multiple of 4"),
        *(
            ({"layup": layup}, "choose one of CP, SB, BP, or give the number of equal plies in a block")
            for layup in ("0", "-1", "1.5", "\N{SUPERSCRIPT TWO}", "")
        ),
    ],
)
def test_impossible_cases_are_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(EXAMPLE, **changed)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"quality": 1.0}, "unknown parameter 'quality': known are gamma_lock"),
        ({"gamma_lock": 0.0}, "gamma_lock = 0 deg must be from 3 to below 90"),
        ({"eps_lock": 0.05}, "eps_lock = 0.05 must be below 0"),
        ({"kappa": float("nan")}, "kappa = nan"),
        ({"h0": -1.0}, "h0 = -1 mm must be above 0"),
        ({"fibre_fraction_initial": 0.9}, "eps_lock = .* must be below 0 by at least 0.0001"),
        ({"fibre_fraction_initial": 1.5}, "between 0 and 1"),
    ],
)
def test_impossible_settings_are_refused(settings: dict[str, float], message: str, manifest: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=message):
        values_with(manifest, **settings)


def test_every_setting_name_is_accepted(manifest: dict[str, Any]) -> None:
    values = property_values(EXAMPLE, manifest)
    for name in setting_names(manifest):
        values_with(manifest, **{name: values.get(name, {"eps_lock_bulk": -0.2, "gamma_lock": 80.0}.get(name, 0.5))})


def test_a_layup_may_be_the_number_of_equal_plies_in_a_block_and_the_law_has_the_case_s_constants() -> None:
    assert replace(EXAMPLE, layup="4").block_thickness == EXAMPLE.block_thickness
    three = Case("IM7-8552", 70.0, "3", 50.0, plies=24)
    assert three.block_thickness == pytest.approx(0.375)
    assert three.blocks * three.law().h0 == pytest.approx(3.0)
    assert (three.law().w0, three.law().k) == (50.0, 0.813)


def test_a_load_file_is_read_with_the_case(tmp_path: Path) -> None:
    path = tmp_path / "press.csv"
    path.write_text("time [s],force [N]\n0,0\n1,45\n600,45\n")
    case = replace(EXAMPLE, load=str(path))
    assert case.load_programme.peak == pytest.approx(0.2)
    assert f"load: straight pieces through the readings of {path}" in assumption_lines(case, vars(case.law()))
