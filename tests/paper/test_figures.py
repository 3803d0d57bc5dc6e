"""The figures: their data against single runs, what stands in their files, that nothing covers anything."""

from __future__ import annotations

import contextlib
import io
import json
import re
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from selenium.webdriver import Chrome

from browsing import faults_of_report
from plyflow.case.case import Case
from plyflow.case.programme import load_programme
from plyflow.cli import main
from plyflow.cli.report import split_numbers
from plyflow.errors import InputError, OutputError
from plyflow.law import Stage, integrate
from plyflow.paper.claims_map import verdict_figure
from plyflow.paper.paper_figure import PaperFigure
from plyflow.paper.run import FIGURES, Report, make_report, write_report
from plyflow.run.case_run import run_case
from plyflow.show.figure import STYLE
from plyflow.umat.prepare import prepare_umat

NUMBERS = ("2a", "2b", "6a", "6b", "7", "8", "9", "10", "11")
PNG_HEAD = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def report() -> Report:
    return make_report({}, with_map=False)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[dict[str, str]]]:
    """Folder and printed claims of the whole command."""
    path, printed = tmp_path_factory.mktemp("figures"), io.StringIO()
    with contextlib.redirect_stdout(printed):
        assert main(["figures", "-o", str(path), "--json"]) == 0
    return path, json.loads(printed.getvalue())


@pytest.fixture(scope="module")
def folder(written: tuple[Path, list[dict[str, str]]]) -> Path:
    return written[0]


def figure_of(report: Report, number: str) -> PaperFigure:
    return next(figure for figure in report.figures if figure.number == number)


def law_error(table: pd.DataFrame, column: str, stack: float, shift: float = 0.0) -> float:
    """Largest relative error of a thickness [mm] over time against the stepwise integrator, sampled."""
    errors = []
    for (temperature, layup, width), rows in table.groupby(["temperature", "layup", "width"]):
        some = rows.iloc[5::97]
        law, load = Case("IM7-8552", temperature, layup, width).law(), load_programme("ramp-dwell", width)
        wanted = stack * integrate(law, load, np.minimum(some["time_s"], load.end)).thickness_ratio
        errors.append(float(np.max(np.abs((some[column] + shift) / wanted - 1.0))))
    return max(errors)


def test_all_figures_of_the_paper_are_there(report: Report) -> None:
    assert tuple(FIGURES) == NUMBERS
    assert tuple(figure.number for figure in report.figures) == NUMBERS


def test_histories_are_those_of_the_law(report: Report) -> None:
    table = figure_of(report, "2b").table
    some = table[table["temperature"].isin([30.0, 80.0])]
    assert set(table["layup"]) == {"CP", "BP"}
    assert set(table["temperature"]) == {30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0}
    assert law_error(some, "thickness_mm", 2.0) < 1e-9
    assert law_error(some, "thickness_mm", 2.0, shift=1e-6) > 1e-7
    assert law_error(figure_of(report, "8").table, "thickness_mm_1d", 2.0) < 1e-9


def test_umat_figures_are_those_of_single_runs(report: Report) -> None:
    table = pd.concat([figure_of(report, "9").table, figure_of(report, "10").table])
    assert len(table) == 84
    umat = prepare_umat()

    def error(rows: pd.DataFrame) -> float:
        errors = []
        for row in rows.to_dict("records"):
            single = run_case(Case(row["material"], row["temperature"], row["layup"], row["width"]), umat)
            stack = 16.0 * (0.125 if row["material"] == "IM7-8552" else 0.165)
            errors.append(abs(row["thickness_mm"] - stack * float(single.thickness_ratio[-1])))
        return max(errors)

    assert error(table.iloc[3::29]) < 1e-12
    shifted = table.assign(thickness_mm=np.roll(table["thickness_mm"], 1))
    assert error(shifted.iloc[3::29]) > 1e-2
    widths = figure_of(report, "11").table
    assert len(widths) == 28
    np.testing.assert_allclose(widths["width_ratio"], widths["width_ratio_1d"], rtol=2e-4)


def test_the_diagram_gives_back_what_was_put_in(report: Report) -> None:
    table = figure_of(report, "7").table
    bounds = {"k": 1e-4, "a": 2e-4, "b_squeeze": 5e-3, "b_bleed": 2e-3}  # of the first order in the increment
    for name, rows in table.groupby("parameter"):
        assert len(rows) == 21
        assert (rows["found"] - rows["put_in"]).abs().max() < bounds[str(name)]
        assert (rows["found"].shift(3) - rows["put_in"]).abs().max() > bounds[str(name)]  # another temperature's


def test_the_diagram_is_straight_only_for_its_k(report: Report) -> None:
    lines = report.model.creep_lines(70.0, "BP")
    assert abs(lines.k - 0.813) < 1e-4
    points = lines.lines[Stage.BLEED]
    assert 1.0 - points.r_squared < 1e-5
    bent = np.polynomial.polynomial.polyfit(np.log(points.rate), np.log(points.ratio) + 0.01 * np.log(points.rate) ** 2, 1)
    residual = np.log(points.ratio) - bent[0] - bent[1] * np.log(points.rate)
    assert np.max(np.abs(residual)) > 0.1


def test_files_say_what_and_how(report: Report, folder: Path) -> None:
    wanted = {f"fig{number}.{ending}" for number in NUMBERS for ending in ("png", "svg", "csv")}
    wanted |= {"claims-map.png", "claims-map.svg", "claims-map.csv"}
    wanted |= {"index.html", "claims.csv", "figures.json"}
    assert {path.name for path in folder.iterdir()} == wanted
    record = json.loads((folder / "figures.json").read_text())
    assert record["figures"]["fig6a"]["command"] == "plyflow figures --only 6a"
    assert "Fortran" in record["provenance"]["compiler"]
    assert any(line.startswith("gamma_lock from k") for line in record["assumptions"])
    for figure in report.figures:
        assert "no measured points" in figure.caption
        assert (folder / f"{figure.name}.png").read_bytes().startswith(PNG_HEAD)
        assert len(pd.read_csv(folder / f"{figure.name}.csv")) == len(figure.table)


def outside_links(page: str) -> list[str]:
    return re.findall(r"""(?:src|href)=["'](?!#)[^"']*|url\((?!#)|https?://(?!www\.w3\.org/)""", page)


def test_the_page_needs_nothing_else(report: Report, folder: Path) -> None:
    page = (folder / "index.html").read_text()
    assert outside_links(page) == []
    assert outside_links(page + '<img src="fig2a.png">') != []
    assert page.count("<svg") == len(NUMBERS) + 1
    for figure in report.figures:
        assert f'id="{figure.name}"' in page
        assert f"{figure.name}.png, command {figure.command}<" in page
    for words in ("does not hold", "cannot be judged", "holds: 6"):
        assert words in page


def test_the_same_call_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    write_report(make_report({}, ["6a", "9"]), tmp_path)
    for name in ("fig6a.svg", "fig6a.png", "fig6a.csv", "fig9.svg", "fig9.png", "fig9.csv"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()
    assert not (tmp_path / "index.html").exists()


def covered(figure: Figure) -> list[str]:
    """Points of lines under a legend, and texts that overlap each other."""
    canvas = FigureCanvasAgg(figure)
    with matplotlib.rc_context(STYLE):
        canvas.draw()
    renderer = canvas.get_renderer()
    found = []
    for axes in figure.axes:
        found += [f"legend over a line of {axes.get_title(loc='left')}"] * _under_legend(axes)
    boxes = [box for axes in figure.axes for box in _text_boxes(axes, renderer)]
    for place, (box, words) in enumerate(boxes):
        found += [f"{words} over {other}" for second, other in boxes[place + 1 :] if box.overlaps(second)]
    return found


def _under_legend(axes: Axes) -> int:
    legend = axes.get_legend()
    if legend is None:
        return 0
    box = legend.get_window_extent()
    hidden = 0
    for line in axes.lines:
        path = line.get_transform().transform(np.column_stack([line.get_xdata(), line.get_ydata()]).astype(float))
        steps = np.linspace(0.0, 1.0, 20)[:, None, None]
        dense = (path[:-1] + steps * np.diff(path, axis=0)).reshape(-1, 2) if len(path) > 1 else path
        inside = (dense > [box.x0, box.y0]) & (dense < [box.x1, box.y1])
        hidden += int(np.any(inside.all(axis=1)))
    return hidden


def _text_boxes(axes: Axes, renderer: RendererAgg) -> list[tuple[Bbox, str]]:
    """Boxes of titles, axis labels and the tick labels within the axes."""
    texts = [axes.xaxis.label, axes.yaxis.label, axes.title, axes._left_title]
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        texts += [label for tick in ticks for label in (tick.label1, tick.label2)]
    return [(t.get_window_extent(renderer), t.get_text()) for t in texts if t.get_visible() and t.get_text()]


@pytest.mark.parametrize("number", NUMBERS)
def test_nothing_covers_anything(report: Report, number: str) -> None:
    assert covered(figure_of(report, number).figure) == []


def test_covering_is_seen() -> None:
    figure = make_report({}, ["6a"]).figures[0].figure
    axes = figure.axes[0]
    assert covered(figure) == []
    axes.legend(loc="upper right")
    assert covered(figure)
    axes.legend(loc="lower left")
    axes.set_xticks(np.geomspace(1e-5, 1e1, 60), ["a long label"] * 60)
    assert covered(figure)


def test_settings_reach_the_figures_and_their_command() -> None:
    changed = make_report({"gamma_lock": 70.0}, ["2a"])
    widths = changed.figures[0].table.set_index(["layup", "width", "temperature"])["width_ratio"]
    wanted = np.sqrt(1.0 + 2.0 / 3.0 * 0.5 / 15.0 * np.tan(np.radians(70.0)))  # Eq. 6: exp(-eps_lock)
    assert widths["BP", 15.0, 70.0] == pytest.approx(wanted, rel=1e-9)
    assert changed.command(changed.figures[0]) == "plyflow figures --only 2a --set gamma_lock=70.0"


def test_what_is_wrong_is_one_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no figure '3': choose of 2a"):
        make_report({}, ["3"])
    with pytest.raises(InputError, match="unknown parameter 'colour'"):
        make_report({"colour": 1.0}, ["2b"])
    (tmp_path / "fig2b.png").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        write_report(make_report({}, ["2b"]), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["fig2b.png"]  # nothing half written


def test_the_command_prints_verdicts_and_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["figures", "--only", "2a", "-o", str(tmp_path)]) == 0
    names = {Path(line).name for line in capsys.readouterr().out.split()}
    assert names == {"fig2a.png", "fig2a.svg", "fig2a.csv", "figures-2a.json"}
    assert main(["figures", "--only", "12", "-o", str(tmp_path)]) == 2
    assert "no figure '12'" in capsys.readouterr().err


def test_figures_are_chosen_with_commas_or_repeated() -> None:
    assert split_numbers(["6a,7"]) == split_numbers(["6a", "7"]) == split_numbers(["6a, 7", "6a"]) == ["6a", "7"]
    assert split_numbers(["6a"]) != split_numbers(["6a,7"])
    with pytest.raises(InputError, match="leaves a figure number out"):
        split_numbers(["6a,,7"])


def test_the_claims_are_printed_as_they_stand_in_the_table(written: tuple[Path, list[dict[str, str]]]) -> None:
    path, claims = written
    table = pd.read_csv(path / "claims.csv")
    assert list(table["claim"]) == [claim["claim"] for claim in claims]
    assert [claim["verdict"] for claim in claims].count("holds") == 6
    assert all("holds" in claim["range"] or "open" in claim["range"] for claim in claims)


def test_nothing_covers_anything_on_the_map(folder: Path) -> None:
    assert covered(verdict_figure(pd.read_csv(folder / "claims-map.csv"), [75.0, 86.0], 4294.0).figure) == []


def test_a_reader_sees_the_whole_report(folder: Path, browser: Chrome, tmp_path: Path) -> None:
    assert faults_of_report(browser, (folder / "index.html").read_text(encoding="utf-8"), tmp_path) == []
