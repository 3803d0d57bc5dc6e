"""The files of `plyflow abaqus`: what is in them, that they keep the keyword rules, that planted errors are seen."""

from __future__ import annotations

import re
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest

from abaqus.keywords import Keyword, problems, read
from plyflow.case.case import Case
from plyflow.case.programme import load_programme
from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.hosts.abaqus.package import abaqus_files
from plyflow.hosts.deck import entries, number, numbers
from plyflow.umat.prepare import prepare_umat

CASE = Case("IM7-8552", 70.0, "BP", 15.0)
SOLID, PLANE = ("c3d8", "c3d8r", "c3d8h"), ("cpe4", "cax4")
LOADS = ("ramp_dwell", "monotonic")
COMMAND = ["abaqus", "--material", "IM7-8552", "-o"]


@pytest.fixture(scope="module")
def files() -> dict[str, str]:
    return abaqus_files("default", CASE)


def decks(files: dict[str, str]) -> dict[str, str]:
    return {name: text for name, text in files.items() if name.endswith(".inp")}


def keywords(text: str, name: str) -> list[Keyword]:
    return [entry for entry in read(text) if entry.name == name]


def jobs(*elements: str) -> set[str]:
    return {f"{element}_{load}.inp" for element in elements for load in LOADS}


def test_every_job_is_there_with_its_source(files: dict[str, str]) -> None:
    assert set(decks(files)) == jobs(*SOLID, *PLANE) | {"laminate.inp"}
    patterns = dict(re.findall(r"^    (\S+\.for) for (.*)$", files["README.txt"], re.MULTILINE))
    assert set(patterns) == {"default.for", "default_p.for"}
    for name, text in decks(files).items():
        source = "default_p.for" if name.startswith(PLANE) else "default.for"
        command = f"abaqus job={name[:-4]} user={source} interactive"
        assert f"** {command}\n" in text
        assert command in files["README.txt"]
        fitting = [file for file, some in patterns.items() if any(fnmatch(name[:-4], one) for one in some.split(", "))]
        assert fitting == [source]
        assert source in files


@pytest.mark.parametrize("scene", ["default", "symmetric", "table", "bdf1"])
def test_the_decks_keep_the_keyword_rules_and_go_without_extrapolation(scene: str) -> None:
    for name, text in decks(abaqus_files(scene, CASE)).items():
        assert problems(text) == [], name
        assert {step.parameters["EXTRAPOLATION"] for step in keywords(text, "STEP")} == {"NO"}, name


@pytest.mark.parametrize("element", [*SOLID, *PLANE])
def test_a_deck_has_its_element_and_what_that_needs(element: str, files: dict[str, str]) -> None:
    text = files[f"{element}_ramp_dwell.inp"]
    assert keywords(text, "ELEMENT")[0].parameters["TYPE"] == element.upper()
    assert ("*HOURGLASS STIFFNESS" in text) == (element == "c3d8r")
    hybrid = "INCREMENTAL" if element == "c3d8h" else None
    assert keywords(text, "USER MATERIAL")[0].parameters.get("HYBRID FORMULATION") == hybrid
    assert ("*ORIENTATION" in text) == element.startswith("c3d8")
    assert "NTENS = 4" in files["default_p.for"]


def test_the_card_names_every_constant_with_its_value_and_unit(files: dict[str, str]) -> None:
    text = files["c3d8_ramp_dwell.inp"]
    commented = re.findall(r"^\*\*   \d+ (\w+) = (\S+) \[(.+?)\]", text, re.MULTILINE)
    given = keywords(text, "USER MATERIAL")[0]
    values = [float(value) for value in given.values]
    assert [float(value) for _, value, _ in commented] == values
    assert given.parameters["CONSTANTS"] == str(len(values))
    assert "UNSYMM" in given.parameters
    assert [name for name, _, _ in commented][:3] == ["w0", "h0", "l0_over_d"]
    assert values[1] == pytest.approx(4 * 0.125)


def test_a_symmetric_scene_asks_for_no_unsymmetric_equations() -> None:
    assert "UNSYMM" not in abaqus_files("symmetric", CASE)["c3d8_monotonic.inp"]


def test_state_variables_are_named(files: dict[str, str]) -> None:
    count, *rows = keywords(files["c3d8_ramp_dwell.inp"], "DEPVAR")[0].data
    assert count == ["10"]
    assert [fields[1] for fields in rows] == [
        "EPS", "WIDTH", "J", "FIBRE_FRACTION", "LOCKED", "PRESSURE", "EPS_RATE", "DISSIPATION",
        "MEAN_STRESS", "DT_LAST",
    ]  # fmt: skip


@pytest.mark.parametrize("load", LOADS)
def test_amplitude_and_steps_are_those_of_the_programme(load: str, files: dict[str, str]) -> None:
    text, programme = files[f"c3d8_{load}.inp"], load_programme(load.replace("_", "-"), 15.0)
    values = [float(value) for value in keywords(text, "AMPLITUDE")[0].values]
    assert values[::2] == pytest.approx(programme.times)
    assert values[1::2] == pytest.approx(programme.pressures)
    durations = [float(entry.data[0][1]) for entry in keywords(text, "STATIC")]
    assert durations == pytest.approx(np.diff(programme.times))
    assert len(keywords(text, "DLOAD")) == 1


PLANTED = [
    ("*USER MATERIAL, CONSTANTS=17", "*USER MATERIAL, CONSTANTS=16", "CONSTANTS=16, but 17 are given"),
    ("*STATIC", "*STATICS", "*STATICS is no keyword in use"),
    ("*DLOAD, AMPLITUDE=PLATE", "*DLOAD, AMPLITUDE=PLATES", "the amplitude 'PLATES' is not defined above"),
    ("NLGEOM=YES", "NLGEOM=MAYBE", "*STEP, NLGEOM=MAYBE is not one of"),
    ("MATERIAL=PLY,", "MATERIAL=PLYS,", "the material 'PLYS' is not defined above"),
    ("EDGELOW, 2, 2, 0.0", "EDGE, 2, 2, 0.0", "the nset 'EDGE' is not defined above"),
    ("TYPE=C3D8,", "TYPE=C3D9,", "*ELEMENT, TYPE=C3D9 is not one of"),
    ("1, 1, 2, 4, 3, 5, 6, 8, 7", "1, 1, 2, 4, 3, 5, 6, 8", "element 1 has 7 nodes, its type 8"),
    ("1, 1, 2, 4, 3, 5, 6, 8, 7", "1, 1, 2, 4, 3, 5, 6, 8, 99", "node 99 of element 1 is not defined"),
    ("15.0, 0.5, 4294.0", "15.0, O.5, 4294.0", "'O.5' in a line of *USER MATERIAL is no N"),
    ("15.0, 0.5, 4294.0", "15.0, 0.5000000000000000000, 4294.0", "has 21 characters, a number at most 20"),
    ("*END STEP\n** LOAD2", "** LOAD2", "*STEP belongs into the model, here is the step"),
    ("*DEPVAR", "*HEADING\nnothing\n*DEPVAR", "*DEPVAR has to follow *MATERIAL"),
    ("8, DISSIPATION,", "11, DISSIPATION,", "state variable 11 of 10"),
    ("0.0, 0.0, 1.0, 0.0888", "0.0, 0.0, -1.0, 0.0888", "does not come after"),
    ("*HEADING\nC3D8:", "*HEADING\n\nC3D8:", "an empty"),
    ("10000, EXTRAPOLATION=NO", "10000, EXTRAPOLATION=NONE", "*STEP, EXTRAPOLATION=NONE is not one of"),
    (", UNSYMM", ", UNSYMM=YES", "*USER MATERIAL, UNSYMM takes no value"),
    ("*MATERIAL, NAME=PLY", "*MATERIAL", "*MATERIAL needs the parameter NAME"),
    ("PLY1, P2, 1.0", "PLY1, P2", "2 fields in a line of *DLOAD"),
]


@pytest.mark.parametrize(("right", "wrong", "what"), PLANTED)
def test_a_planted_error_is_found(right: str, wrong: str, what: str, files: dict[str, str]) -> None:
    text = files["c3d8_ramp_dwell.inp"]
    assert right in text
    assert what in " ".join(problems(text.replace(right, wrong, 1)))


def test_a_missing_end_of_the_last_step_is_found(files: dict[str, str]) -> None:
    text = files["c3d8_monotonic.inp"].rstrip().removesuffix("*END STEP")
    assert problems(text) == ["the last *STEP has no *END STEP"]


def test_the_readme_says_what_to_expect_and_what_was_not_run(files: dict[str, str]) -> None:
    text = files["README.txt"]
    for said in ("None of these has been run in Abaqus", "EXTRAPOLATION=NO", "When it does not converge"):
        assert said in text
    assert re.search(r"ramp-dwell +thickness ratio 0\.6\d+, width ratio 1\.15\d+", text)
    assert "gamma_lock = 86.074 deg" in text
    assert max(len(line) for line in text.split("6 What the numbers rest on")[0].splitlines()) <= 135
    assert all(re.search(rf"SDV{i} +SDV_", text) for i in range(1, 11))


@pytest.mark.parametrize(
    ("scenes", "what"),
    [
        (["stressonly"], "no tangent"),
        (["baked"], "has its constants in its source, the decks carry them in *USER MATERIAL"),
        (["lean"], "choose a scene that reads PROPS, for example default"),
        (["printed"], "no derivative at F = I"),
        (["free"], "choose fibre '1'"),
        (["inplane"], "choose fibre '3'"),
        (["default", "printed"], "'printed' cannot start a job"),
        (["default", "default"], "2 scenes are called 'default'"),
    ],
)
def test_scenes_that_the_decks_do_not_fit_are_refused(scenes: list[str], what: str) -> None:
    with pytest.raises(InputError, match=re.escape(what)):
        abaqus_files(scenes[0], CASE, scenes[1:])


def test_the_printed_invariants_leave_no_tangent_at_the_start() -> None:
    """Why they are refused; the scene with the others has one."""
    usable = {}
    for name in ("default", "printed"):
        umat = prepare_umat(name)
        props = [float(row["default"]) for row in umat.manifest["props"]]
        answer = umat.library.call(np.eye(3), np.eye(3), 1.0, props, np.zeros(len(umat.manifest["statev"])))
        finite = bool(np.isfinite(answer.ddsdde).all()) and bool(answer.ddsdde.any())
        usable[name] = finite and not answer.stopped and not answer.messages
    assert usable == {"default": True, "printed": False}


def test_a_plane_scene_gets_the_plane_jobs_and_one_source_to_name() -> None:
    files = abaqus_files("plane", CASE)
    assert set(decks(files)) == jobs(*PLANE)
    assert "Each source fits its own jobs only" not in files["README.txt"]


def test_a_temperature_outside_the_table_is_taken_when_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = [*COMMAND, str(tmp_path), "--temperature", "95"]
    assert main(command) == 2
    assert "--extrapolate" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert main([*command, "--extrapolate"]) == 0
    assert "IM7-8552 at 95 degC" in (tmp_path / "README.txt").read_text()


@pytest.mark.parametrize("value", ["nan", "inf"])
def test_a_temperature_that_is_no_number_is_refused(
    value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*COMMAND, str(tmp_path), "--extrapolate", "--temperature", value]) == 2
    assert f"--temperature {value}: give a finite number in degC" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_the_command_writes_the_files_and_other_scenes_in_one_source_with_a_card_each(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    others = ["--also", "paper", "--also", "plane", "--aba-param", "--set", "kappa=1000"]
    assert main([*COMMAND, str(tmp_path), *others]) == 0
    text = {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert {Path(path).name for path in capsys.readouterr().out.split()} == set(text)
    assert "15 kappa = 1000.0 [MPa]" in text["c3d8_monotonic.inp"]
    cards = [entry.parameters["NAME"] for entry in keywords(text["together_materials.inp"], "MATERIAL")]
    assert cards == ["DEFAULT", "PAPER", "PLANE"]
    assert text["together.for"].count("SUBROUTINE UMAT(") == 1
    assert text["together.for"].count("INCLUDE 'ABA_PARAM.INC'") == 4
    assert "together_materials.inp" in text["README.txt"]


def test_the_card_alone_is_that_of_the_decks(files: dict[str, str]) -> None:
    card = files["material.inc"]
    assert all(card in text for name, text in decks(files).items() if name.startswith("c3d8_"))
    assert keywords(card, "MATERIAL")[0].parameters["NAME"] == "PLY"


def test_only_a_scene_with_a_temperature_table_gets_the_temperature(files: dict[str, str]) -> None:
    tabled = abaqus_files("table", CASE)
    for name in ("c3d8_ramp_dwell.inp", "cpe4_monotonic.inp", "laminate.inp"):
        assert keywords(tabled[name], "INITIAL CONDITIONS")[0].data[0] == ["NALL", "70.0"]
        wrong = tabled[name].replace("NALL, 70.0", "EVERYWHERE, 70.0")
        assert "the nset 'EVERYWHERE' is not defined above" in problems(wrong)
    assert "*TEMPERATURE" in tabled["README.txt"]
    assert not any("INITIAL CONDITIONS" in text for text in decks(files).values())


@pytest.mark.parametrize("value", [1.0, -0.05934841340231182, 1e-300, -1.2345678901234567e-123, 123456789.0, 0.1 + 0.2])
def test_numbers_fit_into_twenty_characters_and_read_back(value: float) -> None:
    text = number(value)
    assert len(text) <= 20
    assert float(text) == pytest.approx(value, rel=1e-11)
    assert "." in text or "e" in text


def test_what_is_not_finite_is_not_written() -> None:
    with pytest.raises(InputError, match="must be finite"):
        number(float("nan"))


def test_lists_are_broken_where_they_have_to_be() -> None:
    assert numbers([1.0] * 9).splitlines()[1] == "1.0"
    assert entries(list(range(14))).splitlines() == ["0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11,", "12, 13"]
