"""Cases of a sweep: ranges, grids, lists, and what is refused before anything runs."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.sweep.axes import read_axis
from plyflow.sweep.plan import make_plan
from plyflow.sweep.sources import Grid, Source, read_source

BASE = ("--grid", "material=IM7-8552", "--grid", "layup=CP")


def rows_of(source: Source) -> list[dict[str, str | float]]:
    """All cases, three at a time."""
    return [row for start in range(0, len(source), 3) for row in source.rows(start, start + 3)]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("30:90:10", [30, 40, 50, 60, 70, 80, 90]),
        ("30:95:20", [30, 50, 70, 90]),
        ("0:0.3:0.1", [0.0, 0.1, 0.2, 0.3]),
        ("90:30:-30", [90, 60, 30]),
        ("30:90@4", [30, 50, 70, 90]),
        ("30:50:10, 75", [30, 40, 50, 75]),
        ("15:30@97", [float(f"{15.0 + place * 0.15625:.12g}") for place in range(97)]),
        ([30, "40:60:10"], [30, 40, 50, 60]),
        (70, [70]),
    ],
)
def test_ranges_hold_both_ends_and_no_rounding(text: object, values: Sequence[float]) -> None:
    axis = read_axis("temperature", text)
    assert [axis[place] for place in range(len(axis))] == values  # exactly: 0.3 and not 0.30000000000000004
    with pytest.raises(IndexError):
        axis[len(axis)]


def test_a_long_axis_takes_eight_bytes_a_value_and_its_grid_no_more() -> None:
    axis = read_axis("temperature", "30:90@500000")
    assert (axis.size, axis[-1], axis.nbytes) == (500_000, 90.0, 4_000_000)
    grid = Grid({"temperature": axis, "width": axis})
    assert len(grid) == 250_000_000_000
    assert grid.rows(len(grid) - 1, len(grid) + 9) == [{"temperature": 90.0, "width": 90.0}]


def test_a_grid_is_every_combination_the_last_name_fastest() -> None:
    source, _ = read_source(None, ["layup=CP,BP", "width=15,30", "temperature=30:90@3"], {"material": "IM7-8552"})
    wanted = itertools.product(["IM7-8552"], ["CP", "BP"], [15.0, 30.0], [30.0, 60.0, 90.0])
    assert [tuple(row.values()) for row in rows_of(source)] == list(wanted)
    assert source.columns == ("material", "layup", "width", "temperature")


def test_toml_and_csv_and_grid_give_the_same_cases(tmp_path: Path) -> None:
    grid, listed, table = (tmp_path / name for name in ("grid.toml", "list.toml", "list.csv"))
    grid.write_text('model = "umat"\n[grid]\nmaterial = "IM7-8552"\nlayup = ["CP", "BP"]\ntemperature = "70:90:20"\n')
    cases = [("CP", 70), ("CP", 90), ("BP", 70), ("BP", 90)]
    lines = [f'[[case]]\nmaterial = "IM7-8552"\nlayup = "{layup}"\ntemperature = {t}\n' for layup, t in cases]
    listed.write_text("\n".join(lines))
    rows = [f"IM7-8552;{layup};{t}" for layup, t in cases]
    table.write_text("# a comment\nmaterial;layup;temperature [degC]\n" + "\n".join(rows) + "\n")
    sources = [read_source(path, [], {}) for path in (grid, listed, table)]
    assert [said for _, said in sources] == [{"model": "umat"}, {}, {}]
    first = rows_of(sources[0][0])
    assert len(first) == 4
    assert all(rows_of(source) == first for source, _ in sources)


def test_the_key_follows_the_content_and_not_the_spelling(tmp_path: Path) -> None:
    def key(temperature: str, material: str = "IM7-8552") -> str:
        entries = [f"temperature={temperature}", f"material={material}", "layup=CP"]
        return make_plan(read_source(None, entries, {})[0], "law1d").key()

    own = tmp_path / "own.toml"
    text = (Path(__file__).parents[2] / "python/plyflow/data/materials/im7-8552.toml").read_text()
    own.write_text(text)
    before = key("30", str(own))
    own.write_text(text + "\n# another number\n")
    assert key("30:90:30") == key("30,60,90") != key("30,60")
    assert key("30", str(own)) != before


ERRORS: list[tuple[Sequence[str], str]] = [
    ((), "give either a FILE"),
    (("nowhere.csv",), "nowhere.csv cannot be read"),
    (("cases.txt",), "from a .toml or a .csv file"),
    ((*BASE,), "no temperature given"),
    (("--grid", "temprature=30,40"), "unknown name 'temprature', did you mean temperature?"),
    (("--grid", "materal=IM7-8552"), "unknown name 'materal', did you mean material?"),
    ((*BASE, "--grid", "temperature"), "write NAME=VALUES"),
    ((*BASE, "--grid", "temperature=hot"), "'hot' is no number"),
    ((*BASE, "--grid", "temperature="), "no values given"),
    ((*BASE, "--grid", "temperature=30:90:-10"), "never gets from 30 to 90"),
    ((*BASE, "--grid", "temperature=30:90:0"), "change the step 0"),
    ((*BASE, "--grid", "temperature=30:90"), "is no range"),
    ((*BASE, "--grid", "temperature=30:90@1"), "whole number from 2"),
    ((*BASE, "--grid", "temperature=0:1e9:1"), "more than 10000000 values"),
    ((*BASE, "--grid", "temperature=70", "--grid", "layup=BP"), "layup is given twice"),
    ((*BASE, "--grid", "temperature=70", "--set", "width=15,30"), "takes one value"),
    ((*BASE, "--grid", "temperature=70", "--grid", "colour=1"), "unknown name 'colour'"),
    ((*BASE, "--grid", "temperature=70", "--grid", "scene=default"), "'scene' (only with --model umat or laminate)"),
    ((*BASE, "--grid", "temperature=70", "--grid", "kappa=1"), "unknown name 'kappa'"),
    ((*BASE, "--grid", "temperature=70", "--grid", "load=sudden"), "unknown load 'sudden'"),
    ((*BASE, "--grid", "temperature=70", "--model", "fem"), "unknown model 'fem'"),
    ((*BASE, "--grid", "temperature=70", "--model", "umat", "--set", "scene=nowhere"), "'nowhere'"),
    ((*BASE, "--grid", "temperature=70", "--chunk", "0"), "0 cases a part"),
    ((*BASE, "--grid", "temperature=70", "--workers", "-1"), "--workers -1"),
    ((*BASE, "--grid", "temperature=70", "--workers", "1", "--scheduler", "tcp://localhost:1"), "not both"),
    (("--grid", "material=steel", "--grid", "layup=CP", "--grid", "temperature=70"), "unknown material 'steel'"),
    (("--grid", "material=IM7-8552", "--grid", "layup=QI", "--grid", "temperature=70"), "unknown layup 'QI'"),
]


@pytest.mark.parametrize(("arguments", "fragment"), ERRORS, ids=[" ".join(error[0][-2:]) for error in ERRORS])
def test_what_no_case_could_have_is_one_line(
    arguments: Sequence[str],
    fragment: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", *arguments, "-o", "out", "--json"]) == 2
    out, error = capsys.readouterr()
    assert error.count("\n") == 1
    assert fragment in error
    assert out == ""
    assert not list(tmp_path.rglob("result*"))


@pytest.mark.parametrize(
    ("name", "text", "fragment"),
    [
        ("a.csv", "", "is empty"),
        ("a.csv", "material,layup,temperature\n", "no cases"),
        ("a.csv", "material,layup,layup\n", "column name 'layup'"),
        ("a.csv", "material,layup,temperature\nIM7-8552,CP,70\nIM7-8552,CP,7o\n", "line 3: temperature: '7o' is no number"),
        ("a.csv", "material,layup,temperature\nIM7-8552,CP,70,5\n", "line 2: 4 cells for 3 columns"),
        ("a.toml", "grid = 3", "either one [grid] table"),
        ("a.toml", "[grid", "is not TOML"),
        ("a.toml", "modell = 'umat'\n[grid]\n", "unknown key 'modell'"),
        ("a.toml", "[[case]]\nmaterial = 3\n", "case 1: material: 3 is no text"),
        ("a.toml", "[[case]]\nwidth = true\n", "case 1: width: True is no number"),
    ],
)
def test_a_faulty_list_is_refused_with_its_place(tmp_path: Path, name: str, text: str, fragment: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=fragment.replace("[", r"\[")):
        make_plan(read_source(tmp_path / name, [], {})[0], "law1d")
