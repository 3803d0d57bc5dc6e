"""Cycles of temperature and pressure from one file: law1d, run with the table scene, sweep, and every column accounted for."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from plyflow.case.case import Case, driver_steps, property_values, props_vector
from plyflow.case.loads import read_load
from plyflow.cli import main
from plyflow.driver.drive import Controls, drive
from plyflow.errors import InputError
from plyflow.run.case_run import case_controls, run_case
from plyflow.umat.prepare import prepare_umat

HEAT = "time [min],temperature [degC],pressure [bar]\n0,50,0\n1,50,1\n4,80,1\n10,80,2\n"
UNITS = "time [s];T [K];force [kN]\n0;323,15;0\n60;323,15;0,0225\n240;353,15;0,0225\n600;353,15;0,045\n"
COOL = HEAT.replace("10,80,2", "10,80,2\n40,30,2")
NAMES = ("material", "layup", "load")
LAW = ("law1d", "--material", "IM7-8552", "--layup", "BP")
RUN = ("run", "--material", "IM7-8552", "--layup", "BP")


@pytest.fixture
def heat(tmp_path: Path) -> Path:
    path = tmp_path / "heat.csv"
    path.write_text(HEAT)
    return path


def cycle(path: Path, layup: str = "BP", **settings: float) -> Case:
    return Case("IM7-8552", math.nan, layup, 15.0, str(path), settings)


def test_units_in_the_heading_are_taken(heat: Path, tmp_path: Path) -> None:
    other = tmp_path / "units.csv"
    other.write_text(UNITS)
    one, two = read_load(heat, 15.0), read_load(other, 15.0)
    assert one.times == two.times
    assert one.pressures == pytest.approx(two.pressures)
    assert one.temperatures == pytest.approx(two.temperatures)


def test_the_umat_with_temp_and_dtemp_is_the_law_through_the_cycle(heat: Path) -> None:
    """1e-3 is what bdf1 leaves of the final thickness at the default increments, isothermal too; errors fall with them."""
    umat = prepare_umat("table")
    coarse, fine = (run_case(cycle(heat), umat, case_controls(refinement, "bdf1")) for refinement in (1.0, 8.0))
    errors = [abs(float(one.thickness_ratio[-1] - one.law.thickness_ratio[-1])) for one in (coarse, fine)]
    assert errors[0] < 1e-3
    assert errors[1] < 0.25 * errors[0]
    assert coarse.width_ratio[-1] == pytest.approx(coarse.law.width_ratio[-1], abs=1e-4)
    assert coarse.lock_time == pytest.approx(coarse.law.lock_time, rel=2e-2)
    assert coarse.summary()["temperature_range"] == (50.0, 80.0)


def test_without_its_temperature_the_umat_is_off_the_law(heat: Path) -> None:
    case, umat = cycle(heat), prepare_umat("table")
    values = property_values(case, umat.manifest, follows=True)
    load = case.load_programme
    cold = [vars(step) | {"temperature": None} for step in driver_steps(load)]
    steps = [type(driver_steps(load)[0])(**step) for step in cold]
    arguments = (umat.library, props_vector(values, umat.manifest), len(umat.manifest["statev"]))
    history = drive(*arguments, steps, case_controls(1.0, "bdf1"), temperature=50.0)
    right = run_case(case, umat)
    assert abs(history.deformation_gradient[-1, 2, 2] - right.thickness_ratio[-1]) > 0.02


def test_a_failed_increment_of_a_cycle_is_repeated_at_its_temperature(heat: Path, tmp_path: Path) -> None:
    case, umat = cycle(heat), prepare_umat("table")
    values = property_values(case, umat.manifest, follows=True)
    replay = tmp_path / "failed.txt"
    controls = Controls(initial_increment=5.0, maximum_increment=5.0, minimum_increment=5.0, max_iterations=1)
    steps = driver_steps(case.load_programme)[1:]
    arguments = (umat.library, props_vector(values, umat.manifest), len(umat.manifest["statev"]))
    history = drive(*arguments, steps, controls, temperature=50.0, replay=replay)
    assert history.failure is not None
    assert history.failure.temperature == pytest.approx(50.0 + 30.0 * history.failure.total_time / 180.0)
    assert history.failure.temperature_increment == pytest.approx(5.0 / 6.0)
    told = [float(line.partition("=")[2]) for line in replay.read_text().splitlines() if line.strip().startswith("temperature")]
    assert np.diff(told) == pytest.approx([5.0 / 6.0])


def test_law1d_gives_table_and_figure(heat: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*LAW, "--load", str(heat), "-o", str(tmp_path / "out")]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "left" in text
    assert "k, a and b follow the temperature of" in text
    table = pd.read_csv(tmp_path / "out" / "history.csv")
    assert table["temperature_degC"].iloc[-1] == 80.0
    assert (table["thickness_ratio"] > table["thickness_ratio_limit"]).all()
    assert table["time_left_s"].iloc[-1] > 0.0
    assert (tmp_path / "out" / "cycle.svg").read_text().startswith("<?xml")


def test_run_takes_the_table_of_the_material_by_itself(heat: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*RUN, "--material", "IMA-M21", "--load", str(heat), "--json", "-o", str(tmp_path / "out")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["thickness_ratio_final"] == pytest.approx(found["thickness_ratio_1d"], abs=1e-3)
    assert any("eps_lock: compaction at locking, by Eqs. A.1 and 6 from the k of each" in line for line in found["assumptions"])
    assert any(line.startswith("gamma_lock from k") for line in found["assumptions"])
    assert (tmp_path / "out" / "cycle.svg").exists()


def test_a_sweep_takes_cycles_and_says_the_same(heat: Path, tmp_path: Path) -> None:
    grid = ["--grid", "material=IM7-8552", "--grid", "layup=CP,BP", "--grid", f"load={heat}"]
    for model, more in (("law1d", []), ("umat", ["--set", "scene=table"])):
        assert main(["sweep", *grid, *more, "--model", model, "-o", str(tmp_path / model), "--json"]) == 0
    law, umat = (pd.read_csv(tmp_path / model / "result.csv") for model in ("law1d", "umat"))
    np.testing.assert_allclose(umat["thickness_ratio_1d"], law["thickness_ratio"], rtol=1e-12)
    np.testing.assert_allclose(umat["thickness_ratio"], law["thickness_ratio"], atol=1e-3)
    np.testing.assert_allclose(umat["lock_time_s"], law["lock_time_s"], rtol=2e-2)


def test_a_unit_in_the_heading_of_a_list_of_cases_is_taken(tmp_path: Path) -> None:
    listed = tmp_path / "cases.csv"
    listed.write_text("material,layup,temperature [K],width [cm]\nIM7-8552,BP,343.15,1.5\n")
    assert main(["sweep", str(listed), "-o", str(tmp_path / "out"), "--json"]) == 0
    row = pd.read_csv(tmp_path / "out" / "result.csv").iloc[0]
    assert (row["temperature"], row["width"]) == (pytest.approx(70.0), 15.0)


ERRORS: list[tuple[str, tuple[str, ...], str]] = [
    (HEAT, (*LAW, "--temperature", "70"), "temperature 70 degC is given, and heat.csv has a column of temperature that starts at 50"),
    (HEAT.replace("4,80", "4,353.15"), LAW, "353.15 degC is outside 30 to 90 degC, the range of IM7-8552 (353.15 K are 80 degC"),
    (HEAT.replace("4,80", "4,95"), RUN, "temperature 95 degC is outside 30 to 90 degC"),
    (HEAT.replace("temperature [degC]", "vacuum [mbar]"), LAW, "column 'vacuum [mbar]' is not used here"),
    (HEAT.replace("temperature [degC]", "temperature [R]"), LAW, "unknown unit 'R' of temperature"),
    (HEAT.replace("pressure [bar]", "pressure [MPa]").replace("10,80,2", "10,80,200"), LAW, "give the unit in the heading"),
    (HEAT, (*RUN, "--scene", "default"), "scene 'default' has one k, a and b"),
    (HEAT, (*RUN, "--scene", "table", "--material", "IMA-M21"), "has k = 0.86 at 50 degC in its temperature table"),
    (COOL, RUN, "on cooling has brought the compaction limit past the ply, and the UMAT has no stress there"),
    (HEAT.replace("1,50,1", "1,,1").replace("4,80,1", "4,80,x"), LAW, "2 faulty rows: line 3: no value of temperature"),
    ("time [s],pressure [MPa]\n0,0\n9,1\n", LAW, "no temperature given, and load heat.csv has none"),
    (HEAT, ("laminate", "--material", "IM7-8552", "--layup", "BP", "--temperature", "50"), "law1d, run and sweep follow a cycle"),
]


@pytest.mark.parametrize(("text", "command", "message"), ERRORS)
def test_what_a_cycle_cannot_be_is_said_in_one_line(
    text: str, command: tuple[str, ...], message: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("heat.csv").write_text(text)
    assert main([*command, "--load", "heat.csv", "-o", "out"]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not Path("out").exists()


def test_what_does_not_follow_a_temperature_refuses_a_cycle(heat: Path) -> None:
    for ask in (cycle(heat).law, lambda: property_values(cycle(heat), prepare_umat("table").manifest)):
        with pytest.raises(InputError, match="has a column of temperature, and this calculation takes one temperature"):
            ask()
    with pytest.raises(InputError, match="eps_lock_bulk"):
        property_values(cycle(heat, eps_lock_bulk=-0.1), prepare_umat("table").manifest, follows=True)
