"""Numbers of a sweep against the single runs, and cases that fail."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from sweeping import GRID, grid_plan, result_of, sweep_into

from plyflow.case.case import Case
from plyflow.case.loads import find_load
from plyflow.cli import main
from plyflow.errors import InputError, RunError
from plyflow.law import integrate
from plyflow.run.case_run import run_case
from plyflow.sweep.plan import make_plan
from plyflow.sweep.sources import read_source
from plyflow.umat.prepare import prepare_umat

WORST = 1e-10  # quadrature against stepwise integration


def largest_error(table: pd.DataFrame) -> float:
    """Largest relative difference of thickness, width and lock time to the stepwise integrator."""
    errors = []
    for row in table.to_dict("records"):
        law = Case(row["material"], row["temperature"], row["layup"], row["width"]).law()
        load = find_load(row["load"], row["width"])
        single = integrate(law, load, [load.end])
        for name, value in (("thickness_ratio", single.thickness_ratio[0]), ("width_ratio", single.width_ratio[0])):
            errors.append(abs(row[name] / value - 1.0))
        assert single.lock_time is not None
        errors.append(abs(row["lock_time_s"] / single.lock_time - 1.0) * 1e-2)
    return max(errors)


def test_each_row_is_the_single_run_whatever_stands_beside_it(tmp_path: Path) -> None:
    load = tmp_path / "load.csv"
    load.write_text("time [s],force [N]\n0,0\n5,20\n300,20\n310,60\n600,60\n")
    entries = ("material=IM7-8552,IMA-M21", "temperature=33,70", "layup=CP,4", "width=15,21.7,30")
    sweep_into(tmp_path / "out", grid_plan(*entries, f"load=ramp-dwell,monotonic,{load}"))
    table = result_of(tmp_path / "out")
    assert len(table) == 72
    assert (table["status"] == "done").all()
    sample = table.iloc[::5]
    assert largest_error(sample) < WORST
    planted = sample.assign(thickness_ratio=np.roll(sample["thickness_ratio"], 1))  # rows shifted against their cases
    assert largest_error(planted) > 1e-3


def test_umat_rows_are_those_of_run_case(tmp_path: Path) -> None:
    entries = ("temperature=60", "layup=BP", "width=15,30", "gamma_lock=75,80", "scene=default,augmented", "kappa=1e4")
    sweep_into(tmp_path, grid_plan("material=IMA-M21", *entries, model="umat", chunk=3))
    table = result_of(tmp_path)
    assert len(table) == 8
    for row in table.to_dict("records")[::3]:
        settings = {"gamma_lock": row["gamma_lock"], "kappa": row["kappa"]}
        single = run_case(Case("IMA-M21", 60.0, "BP", row["width"], settings=settings), prepare_umat(row["scene"]))
        summary = single.summary()
        assert row["thickness_ratio"] == summary["thickness_ratio_final"]  # the same increments, to the last bit
        assert row["width_ratio"] == summary["width_ratio_final"]
        assert row["increments"] == summary["increments"]
        assert row["lock_time_s"] == summary["lock_time"]
        assert row["thickness_ratio_1d"] == pytest.approx(summary["thickness_ratio_1d"], rel=WORST)
        assert row["lock_time_1d_s"] == pytest.approx(summary["lock_time_1d"], rel=1e-8)
        assert row["fibre_fraction"] == pytest.approx(single.history.statev[-1, 3], rel=1e-9)
    shown = table.set_index(["gamma_lock", "width", "scene"])["thickness_ratio"]
    assert shown[75.0, 15.0, "default"] != shown[80.0, 15.0, "default"]  # the setting reached the UMAT


def test_failed_cases_stand_in_the_table_with_their_reason(tmp_path: Path) -> None:
    file = tmp_path / "cases.csv"
    lines = ["IM7-8552,70,BP,", "IM7-8552,20,BP,", "IM7-8552,70,BP,2", "IMA-M21,50,CP,0.8", "IM7-8552,nan,CP,", ",70,CP,"]
    file.write_text("\n".join(["material,temperature,layup,k", *lines]))
    outcome = sweep_into(tmp_path / "out", make_plan(read_source(file, [], {"width": 20.0})[0], "law1d"))
    table = result_of(tmp_path / "out")
    assert (outcome.cases, outcome.failed) == (6, 4)
    assert list(table["case"]) == [1, 2, 3, 4, 5, 6]
    assert list(table["status"]) == ["done", "failed", "failed", "done", "failed", "failed"]
    reasons = table["reason"].fillna("").to_list()
    for place, words in ((1, "20 degC is outside"), (2, "k = 2 must be below"), (4, "nan"), (5, "no material given")):
        assert words in reasons[place]
    done = table["status"] == "done"
    assert table.loc[done, "thickness_ratio"].notna().all()
    assert table.loc[~done, "thickness_ratio"].isna().all()
    assert (table["width"] == 20.0).all()
    csv = pd.read_csv(tmp_path / "out" / "result.csv")
    pd.testing.assert_frame_equal(csv, table.assign(reason=table["reason"].astype(csv["reason"].dtype)), check_dtype=False)


@pytest.mark.parametrize("model", ["law1d", "umat"])
def test_extrapolation_only_if_asked_for(tmp_path: Path, model: str) -> None:
    source, _ = read_source(None, ["material=IM7-8552", "temperature=92,90", "layup=BP"], {})
    outcome = sweep_into(tmp_path / "refused", make_plan(source, model))
    assert outcome.failed == 1
    assert sweep_into(tmp_path / "allowed", make_plan(source, model, None, True)).failed == 0
    table = result_of(tmp_path / "allowed")
    law = Case("IM7-8552", 92.0, "BP", 15.0, extrapolate=True).law()
    wanted = integrate(law, find_load("ramp-dwell", 15.0), [1200.0]).thickness_ratio[0]
    assert table["thickness_ratio"][0] == pytest.approx(wanted, rel=WORST if model == "law1d" else 1e-3)
    assert table["thickness_ratio"][0] < table["thickness_ratio"][1]


def test_a_scene_that_cannot_carry_the_case_fails_with_its_reason(tmp_path: Path) -> None:
    plan = grid_plan("material=IM7-8552", "temperature=70", "layup=BP", "scene=default,bleed", model="umat")
    outcome = sweep_into(tmp_path, plan)
    assert outcome.failed == 1
    assert "regimes = 'bleed'" in result_of(tmp_path)["reason"][1]


def test_all_cases_failing_is_an_error_after_the_table_is_written(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"all 2 cases failed.*outside"):
        sweep_into(tmp_path, grid_plan("material=IM7-8552", "temperature=10,20", "layup=BP"))
    assert (result_of(tmp_path)["status"] == "failed").all()


def test_the_result_says_what_it_was_made_with(tmp_path: Path) -> None:
    plan = grid_plan("material=IM7-8552", "temperature=70", "layup=BP", "gamma_lock=75", model="umat")
    sweep_into(tmp_path, plan)
    record = json.loads((tmp_path / "sweep.json").read_text())
    inside = json.loads(pq.read_schema(tmp_path / "result.parquet").metadata[b"plyflow"])
    assert record["inputs"] == inside
    made = inside["umat"]["default"]
    assert "Fortran" in made["compiler"]
    assert len(made["source_sha256"]) == 64
    assert inside["plyflow_version"] == made["plyflow_version"]
    assert any(line.startswith("l0_over_d = 4294") for line in record["assumptions"])
    assert not any(line.startswith("gamma_lock = 80") for line in record["assumptions"])  # it was swept


def test_the_command_reports_counts_and_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = [word for entry in GRID for word in ("--grid", entry)]
    assert main(["sweep", *options, "-o", str(tmp_path / "out"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["cases"], report["failed"], report["run"]) == (84, 0, 84)
    assert [Path(name).name for name in report["files"]] == ["result.parquet", "result.csv", "sweep.json"]
    assert main(["sweep", *options, "-o", str(tmp_path / "out")]) == 0
    assert "complete already" in capsys.readouterr().out


def test_another_sweep_is_not_overwritten_unasked(tmp_path: Path) -> None:
    first, second = (grid_plan("material=IM7-8552", f"temperature={t}", "layup=BP") for t in (60, 70))
    sweep_into(tmp_path, first)
    before = (tmp_path / "result.csv").read_bytes()
    with pytest.raises(InputError, match="holds another sweep"):
        sweep_into(tmp_path, second)
    assert (tmp_path / "result.csv").read_bytes() == before
    sweep_into(tmp_path, second, overwrite=True)
    assert list(result_of(tmp_path)["temperature"]) == [70.0]
