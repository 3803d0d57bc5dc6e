"""Section 5 from sweeps of laminates: their table, the figures and claims made of it."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from plyflow.case.case import all_cases
from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.paper.claims import programme_table
from plyflow.paper.laminates import CLAIMS_OF_LAMINATES, KEYS, read_laminates
from plyflow.paper.run import make_report

BASE = ("--grid", "material=IM7-8552", "--grid", "layup=BP", "--set", "cells=1", "--workers", "0")


def sweep(folder, *options):
    return main(["sweep", "--model", "laminate", *BASE, *options, "-o", str(folder), "--json"])


def test_a_sweep_says_of_each_case_what_a_run_says(tmp_path, capsys):
    assert sweep(tmp_path / "sweep", "--grid", "temperature=70", "--grid", "friction=0.05,-1") == 0
    good, bad = (row for _, row in pd.read_parquet(tmp_path / "sweep" / "result.parquet").iterrows())
    options = ["--material", "IM7-8552", "--temperature", "70", "--layup", "BP", "--cells", "1", "-o", str(tmp_path / "run")]
    capsys.readouterr()
    assert main(["laminate", *options, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (good["thickness_ratio"], good["width_ratio"]) == (found["thickness_ratio_final"], found["width_ratio_final"])
    assert good["thickness_ratio_1d"] == pytest.approx(found["thickness_ratio_1d"], abs=1e-7)
    assert [good[n] for n in ("increments", "iterations", "cutbacks")] == [found[n] for n in ("increments", "iterations", "cutbacks")]
    outer, inner, *_ = found["width_ratio_of_blocks"]
    assert (good["width_ratio_outer"], good["width_ratio_inner"]) == pytest.approx((outer, inner), abs=1e-9)
    assert len(good["times_s"].split()) == found["increments"] + 1
    assert bad["status"] == "failed"
    assert "at least 0" in bad["reason"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--grid", "temperature=70", "--set", "cells=1.5"), "whole number"),
        (("--grid", "temperature=70", "--set", "cell=2"), "unknown name 'cell'"),
    ],
)
def test_what_is_wrong_with_a_sweep_is_one_line(options, said, tmp_path, capsys):
    base = [entry for entry in BASE if entry != "cells=1"]
    base.remove("--set")
    assert main(["sweep", "--model", "laminate", *base, *options, "-o", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


@pytest.fixture
def table():
    """The 56 cases as the law has them, inner blocks a little wider than outer ones."""
    law = programme_table({})
    law = law[law["layup"] != "SB"].reset_index(drop=True)
    names = {"thickness": "thickness_ratio", "limit": "thickness_ratio_limit", "widening": "width_ratio", "lock_time": "lock_time_s"}
    law = law.drop(columns="locked").rename(columns=names)
    ratio, width = law["thickness_ratio"], law["width_ratio"]
    beside = {"thickness_ratio_1d": ratio, "width_ratio_1d": width, "width_ratio_inner": width, "width_ratio_outer": width - 1e-3}
    history = {"times_s": "0 1200", "thickness_ratios": [f"1 {one:.6f}" for one in ratio]}
    said = {"load": "ramp-dwell", "scene": "default", "status": "done", "cells": 8.0, "friction": 0.05, "increments": 60}
    return law.assign(**said, **beside, **history, thickness_mm=2.0 * ratio, locked_share=1.0)


def read(table, folder, points=None):
    table.to_csv(folder / "result.csv", index=False)
    if points is None:
        return read_laminates(folder / "result.csv")
    (folder / "points.csv").write_text(points)
    return read_laminates(folder / "result.csv", folder / "points.csv")


def test_figures_draw_the_table_and_the_points_given(table, tmp_path):
    points = "# ours\nmaterial,temperature,layup,width,thickness_mm\nIM7-8552,70,BP,15,1.234\n"
    model = read(table, tmp_path, points)
    assert model.missing == 0
    report = make_report({}, laminates=model)
    assert [figure.number for figure in report.figures] == ["8", "9", "10", "11"]
    drawn = {figure.number: figure for figure in report.figures}
    ends = drawn["8"].table.groupby([*KEYS], sort=False)["thickness_ratio"].last()
    assert ends[("IM7-8552", 70.0, "BP", 15.0)] == pytest.approx(0.6217, abs=1e-4)
    crosses = [line for line in drawn["9"].figure.axes[0].lines if line.get_marker() == "x" and len(line.get_xdata())]
    assert [line.get_ydata()[0] for line in crosses] == [1.234]
    assert all("8 x 8" in figure.caption and "60 to 60 increments" in figure.caption for figure in report.figures)
    assert list(report.findings) == [claim.key for claim in CLAIMS_OF_LAMINATES]
    assert report.findings["inner"].verdict.value == "holds"


@pytest.mark.parametrize(
    ("key", "change"),
    [
        ("inner", {"width_ratio_inner": 1.0}),
        ("bp-thinner", {"thickness_ratio": 0.7}),
        ("bp-plateau", {"width_ratio": np.linspace(1.0, 2.0, 56)}),
    ],
)
def test_an_altered_table_turns_a_claim(table, tmp_path, key, change):
    report = make_report({}, laminates=read(table.assign(**change), tmp_path))
    assert report.findings[key].verdict.value == "does not hold"


def test_claims_wait_for_all_cases(table, tmp_path):
    model = read(table.iloc[:-2], tmp_path)
    assert (model.missing, make_report({}, laminates=model).findings) == (2, {})
    assert len(table) == sum(case.layup != "SB" for case in all_cases())


@pytest.mark.parametrize(
    ("change", "points", "said"),
    [
        ({"load": "monotonic"}, None, "load monotonic"),
        ({"status": "failed"}, None, "no case was finished"),
        ({"material": "IM7-8552"}, None, "is there twice"),
        ({}, "material,temperature\nIM7-8552,70\n", "no column layup"),
        ({}, "material,temperature,layup,width\nIM7-8552,70,BP,15\n", "no column thickness_mm or width_ratio"),
    ],
)
def test_a_table_that_does_not_fit_is_one_error(table, tmp_path, change, points, said):
    with pytest.raises(InputError, match=said):
        read(table.assign(**change), tmp_path, points)


def test_a_kind_of_specimen_that_is_missing_is_named(table, tmp_path):
    model = read(table[(table["material"] != "IMA-M21") | (table["layup"] != "CP")], tmp_path)
    with pytest.raises(InputError, match="no laminate of IMA-M21 CP 15 mm in the file"):
        make_report({}, laminates=model)
