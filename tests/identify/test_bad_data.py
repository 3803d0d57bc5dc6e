"""Data sets made bad on purpose: none of them ends with a number and exit status 0, and each is told what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from plyflow.case.case import Case
from plyflow.cli import main
from plyflow.identify import valley
from plyflow.run.synthetic import synthetic_test

HEAD = "# layup: CP\n# width: 15 mm\n# ply thickness: 0.125 mm\n# plies: 16\n# temperature: 70 degC\n"
NAMES = ["time [s]", "force [N]", "thickness [mm]"]
TIME, FORCE, THICKNESS = NAMES
Alter = Callable[[pd.DataFrame], pd.DataFrame]


@pytest.fixture(scope="module")
def good() -> pd.DataFrame:
    """A noisy test as it should be, a reading each two seconds."""
    test = synthetic_test(Case("IM7-8552", 70.0, "CP", 15.0), 2.0).with_noise(0.005, 0.1, 8)
    return pd.DataFrame({TIME: test.time, FORCE: test.force, THICKNESS: test.thickness})


@pytest.fixture(autouse=True)
def few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(valley, "POINTS", 5)


def head(old: str, new: str) -> str:
    assert old in HEAD
    return HEAD.replace(old, new)


def scaled(name: str, factor: float) -> Alter:
    return lambda table: table.assign(**{name: table[name] * factor})


def added(values: Callable[[np.ndarray], np.ndarray]) -> Alter:
    """Thickness with something added that depends on the time."""
    return lambda table: table.assign(**{THICKNESS: table[THICKNESS] + values(table[TIME].to_numpy())})


def cells(name: str, rows: list[int], value: object) -> Alter:
    def change(table: pd.DataFrame) -> pd.DataFrame:
        table = table.astype(object)
        table.loc[rows, name] = value
        return table

    return change


def column(heading: str, values: Callable[[np.ndarray], np.ndarray]) -> Alter:
    return lambda table: table.assign(**{heading: values(table[TIME].to_numpy())})


def spikes(time: np.ndarray) -> np.ndarray:
    return np.where(np.arange(time.size) % 97 == 50, 0.15, 0.0)


def same(table: pd.DataFrame) -> pd.DataFrame:
    return table


BAD: dict[str, tuple[str, Alter, tuple[str, ...], str]] = {
    "width in metres": (head("15 mm", "0.015"), same, (), "is it in m? 0.015 m are 15 mm"),
    "width in micrometres": (head("15 mm", "15000 mm"), same, (), "is it in um? 15000 um are 15 mm"),
    "width by option in metres": (HEAD, same, ("--width", "0.015"), "is it in m?"),
    "ply in metres": (head("0.125 mm", "0.000125"), same, (), "ply thickness 0.000125 mm is outside 0.02 to 1 mm"),
    "ply in micrometres": (head("0.125 mm", "125"), same, (), "is it in um? 125 um are 0.125 mm"),
    "temperature in kelvin": (head("70 degC", "343.15"), same, (), "is it in K? 343.15 K are 70 degC"),
    "force in kilonewtons": (HEAD, scaled(FORCE, 1e-3), (), "is it in kN?"),
    "force in millinewtons": (HEAD, scaled(FORCE, 1e3), (), "is it in mN?"),
    "thickness in metres": (HEAD, scaled(THICKNESS, 1e-3), (), "is it in m?"),
    "thickness in micrometres": (HEAD, scaled(THICKNESS, 1e3), (), "is it in um?"),
    "time in minutes": (HEAD, scaled(TIME, 1.0 / 60.0), (), "is it in min? 20 min are 1200 s"),
    "time in milliseconds": (HEAD, scaled(TIME, 1e4), (), "is it in ms?"),
    "force reversed": (HEAD, scaled(FORCE, -1.0), (), "is the sign reversed"),
    "three values missing": (HEAD, cells(THICKNESS, [3, 50, 400], ""), (), "3 faulty rows: line 10: no value of thickness"),
    "texts among the numbers": (HEAD, cells(FORCE, [5, 6], "overload"), (), "2 faulty rows: line 12: force 'overload'"),
    "times that stand": (HEAD, cells(TIME, [70, 71], 138.0), (), "leave them out with --skip-bad-rows"),
    "more bad rows than may be skipped": (
        HEAD, cells(THICKNESS, list(range(100, 300)), ""), ("--skip-bad-rows",), "leaves at most a tenth out",
    ),
    "a column of strain": (HEAD, column("strain [-]", np.zeros_like), (), "column 'strain [-]' is not used here"),
    "thickness twice": (HEAD, column("h [mm]", np.ones_like), (), "two columns hold the thickness"),
    "half the plies": (head("plies: 16", "plies: 8"), same, (), "from the densest packing"),
    "nothing moves": (HEAD, lambda t: t.assign(**{THICKNESS: 2.0}), (), "nothing to fit"),
    "ten readings": (HEAD, lambda t: t[:10], (), "at least 20 are needed"),
    "heated on the way": (HEAD, column("T [degC]", lambda t: 70.0 + t / 60.0), (), "say with --like MATERIAL"),
    "another temperature measured": (HEAD, column("T [degC]", lambda t: 0.0 * t + 60.0), (), "60 degC in the mean, 70 degC is given"),
    "like without a column": (HEAD, same, ("--like", "IM7-8552"), "there is none: leave it out"),
    "no layup": (head("# layup: CP\n", ""), same, (), "no layup given"),
    "the first minute": (HEAD, lambda t: t[:31], (), "a is not determined"),
    "a zero error": (HEAD, added(lambda t: 0.0 * t + 0.05), (), "fit a zero error of the sensor with --offset"),
    "a zero error that the start does not show": (
        HEAD, lambda t: added(lambda s: 0.0 * s + 0.05)(t)[1:], (), "try --offset",
    ),
    "a slip of the sensor": (HEAD, added(lambda t: np.where(t > 600.0, -0.06, 0.0)), (), "the law does not follow them"),
    "a drift": (HEAD, added(lambda t: 4e-5 * t), (), "the law does not follow them"),
    "outliers": (HEAD, added(spikes), (), "the law does not follow them"),
    "force of another test": (HEAD, lambda t: t.assign(**{FORCE: 60.0 * (t[TIME] > 0.0)}), (), "the law does not follow them"),
    "thickness late by 20 s": (
        HEAD, lambda t: t.assign(**{THICKNESS: t[THICKNESS].shift(10).fillna(2.0)}), (), "the law does not follow them",
    ),
    "a sensor at its stop": (HEAD, lambda t: t.assign(**{THICKNESS: t[THICKNESS].clip(lower=1.62)}), (), "come near"),
}  # fmt: skip


WITH_FILES = ("good", "a drift", "the first minute", "force reversed")  # figures take longer than the fit


def status(name: str, table: pd.DataFrame, folder: Path) -> int:
    text, alter, options, _ = BAD[name]
    path = folder / "bad.csv"
    path.write_text(text + alter(table).to_csv(index=False))
    return main(["identify", str(path), *options, *(["-o", str(folder / "out")] if name in WITH_FILES else ["--json"])])


@pytest.mark.parametrize("name", BAD)
def test_no_bad_data_end_with_a_number_and_status_0(
    name: str, good: pd.DataFrame, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert status(name, good, tmp_path) in (1, 2)
    assert BAD[name][3] in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out" / "material.toml").exists()


def test_there_are_thirty_and_the_good_one_passes(
    good: pd.DataFrame, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert len(BAD) >= 30
    monkeypatch.setitem(BAD, "good", (HEAD, same, (), ""))
    assert status("good", good, tmp_path) == 0
    assert (tmp_path / "out" / "material.toml").exists()
