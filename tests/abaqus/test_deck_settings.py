"""The settings of the decks' steps, tried in the driver with a Newton method like Abaqus's, a load drop included."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from abaqus.keywords import Keyword, read
from plyflow.case.case import Case, all_cases, driver_steps, property_values, props_vector
from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.hosts.abaqus.package import abaqus_files
from plyflow.umat.prepare import Umat, prepare_umat

# Abaqus's own: 4 easy iterations twice in a row, growth 1.5, 16 iterations, cut to a quarter, 5 attempts.
ABAQUS = {"growth": 1.5, "easy_iterations": 4, "easy_in_a_row": 2, "cut": 0.25, "max_iterations": 16, "max_attempts": 5}


@dataclass(frozen=True)
class Settings:
    """What a deck says of its increments."""

    first: float
    smallest: float
    largest: float
    residual: float
    force: float
    extrapolation: str


@pytest.fixture(scope="module")
def umat() -> Umat:
    return prepare_umat()


@pytest.fixture(scope="module")
def settings() -> Settings:
    """From the second step of the C3D8 deck, a dwell."""
    deck = list(read(abaqus_files("default", Case("IM7-8552", 70.0, "BP", 15.0))["c3d8_ramp_dwell.inp"]))

    def second(name: str) -> Keyword:
        return [keyword for keyword in deck if keyword.name == name][1]

    sizes, controls = second("STATIC").data[0], second("CONTROLS").data[0]
    return Settings(
        float(sizes[0]),
        float(sizes[2]),
        float(sizes[3]),
        float(controls[0]),
        float(controls[3]),
        "none" if second("STEP").parameters["EXTRAPOLATION"] == "NO" else "linear",
    )


def steps(case: Case) -> list[Step]:
    """The programme, then half the load within 1 s and 100 s of creep under it."""
    loads = driver_steps(case.load_programme)
    lower = dict(loads[-1].targets) | {"33": 0.5 * case.load_programme.peak}
    return [*loads, Step(1.0, lower, loads[-1].kinds), Step(100.0, lower, loads[-1].kinds)]


def run(umat: Umat, case: Case, settings: Settings, **changes: float | str) -> History:
    controls = {
        "initial_increment": settings.first,
        "minimum_increment": settings.smallest,
        "maximum_increment": settings.largest,
        "residual_tolerance": settings.residual,
        "load_scale": case.load_programme.peak,
        "extrapolation": settings.extrapolation,
        "newton": "plain",
        "largest_correction": 10.0,
        "max_increments": 2000,
    }
    values = property_values(case, umat.manifest)
    chosen = Controls(**(ABAQUS | controls | changes))  # type: ignore[arg-type]
    return drive(umat.library, props_vector(values, umat.manifest), len(umat.manifest["statev"]), steps(case), chosen)


def test_residuals_are_compared_with_the_largest_force_on_a_node(settings: Settings) -> None:
    assert settings.force == pytest.approx(Case("IM7-8552", 70.0, "BP", 15.0).load_programme.peak * 15.0 * 15.0 / 4)


@pytest.mark.parametrize("extrapolation", ["none", "linear"])
def test_all_cases_of_the_programme_and_a_load_drop_end_with_the_settings_of_the_decks(
    extrapolation: str, umat: Umat, settings: Settings
) -> None:
    assert settings.extrapolation == "none"
    ends = {case.label: run(umat, case, settings, extrapolation=extrapolation) for case in all_cases()}
    assert {label: history.message for label, history in ends.items() if not history.completed} == {}
    assert len(ends) == 84


def test_without_the_tangent_of_the_last_rate_they_do_not_end(settings: Settings, tmp_path: Path) -> None:
    scene = tmp_path / "stiff.toml"
    scene.write_text('name = "stiff"\nfirst_tangent = "floor"\n')
    stiff = prepare_umat(str(scene))
    ends = [run(stiff, case, settings, max_increments=500) for case in all_cases()[::28]]
    assert not any(history.completed for history in ends)
