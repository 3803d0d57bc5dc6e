"""The files of `plyflow abaqus`: what is in them, that they keep the keyword rules, that planted errors are seen."""

from __future__ import annotations

import re
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest

from plyflow.case.case import Case
from plyflow.case.programme import load_programme
from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.hosts.abaqus.check import problems, read, require_valid
from plyflow.hosts.abaqus.deck import MaterialCard, entries, number, numbers
from plyflow.hosts.abaqus.package import abaqus_files
from plyflow.run.case_run import run_case
from plyflow.umat.prepare import prepare_umat

CASE = Case("IM7-8552", 70.0, "BP", 15.0)
ELEMENTS = ("c3d8", "c3d8r", "c3d8h", "cpe4", "cax4")


@pytest.fixture(scope="module")
def files() -> dict[str, str]:
    return abaqus_files("default", CASE)


def keyword(text: str, name: str) -> list[dict[str, str | None]]:
    """Parameters of every keyword of a name."""
    return [entry.parameters for entry in read(text) if entry.name == name]


def test_every_job_is_there_with_its_source(files: dict[str, str]) -> None:
    jobs = {f"{element}_{load}.inp" for element in ELEMENTS for load in ("ramp_dwell", "monotonic")}
    assert {name for name in files if name.endswith(".inp")} == jobs | {"laminate.inp"}
    for name in jobs | {"laminate.inp"}:
        source = "default_p.for" if name.startswith(("cpe4", "cax4")) else "default.for"
        assert f"** abaqus job={name[:-4]} user={source} interactive" in files[name]
        assert f"abaqus job={name[:-4]} user={source} interactive" in files["README.txt"]
        assert source in files


def test_the_decks_keep_the_keyword_rules(files: dict[str, str]) -> None:
    for name, text in files.items():
        if name.endswith(".inp"):
            assert [str(problem) for problem in problems(text)] == [], name


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_deck_has_its_element_and_what_that_needs(element: str, files: dict[str, str]) -> None:
    text = files[f"{element}_ramp_dwell.inp"]
    assert keyword(text, "ELEMENT")[0]["TYPE"] == element.upper()
    assert ("*HOURGLASS STIFFNESS" in text) == (element == "c3d8r")
    assert keyword(text, "USER MATERIAL")[0].get("HYBRID FORMULATION") == (
        "INCREMENTAL" if element == "c3d8h" else None
    )
    assert ("*ORIENTATION" in text) == element.startswith("c3d8")
    assert ("NTENS = 4" in files["default_p.for"]) and element


def test_the_card_names_every_constant_with_its_value_and_unit(files: dict[str, str]) -> None:
    text = files["c3d8_ramp_dwell.inp"]
    commented = re.findall(r"^\*\*   \d+ (\w+) = (\S+) \[(.+?)\]", text, re.MULTILINE)
    given = next(entry for entry in read(text) if entry.name == "USER MATERIAL")
    values = [float(value) for _, fields in given.data for value in fields if value]
    assert [float(value) for _, value, _ in commented] == values
    assert given.parameters["CONSTANTS"] == str(len(values))
    assert "UNSYMM" in given.parameters
    assert [name for name, _, _ in commented][:3] == ["w0", "h0", "l0_over_d"]
    assert values[1] == pytest.approx(4 * 0.125)


def test_a_symmetric_scene_asks_for_no_unsymmetric_equations() -> None:
    text = abaqus_files("symmetric", CASE)["c3d8_monotonic.inp"]
    assert "UNSYMM" not in text.split("*HEADING")[1]


def test_state_variables_are_named(files: dict[str, str]) -> None:
    depvar = next(entry for entry in read(files["c3d8_ramp_dwell.inp"]) if entry.name == "DEPVAR")
    assert depvar.data[0][1] == ["8"]
    assert [fields[1] for _, fields in depvar.data[1:]] == [
        "EPS", "WIDTH", "J", "FIBRE_FRACTION", "LOCKED", "PRESSURE", "EPS_RATE", "DISSIPATION",
    ]  # fmt: skip


@pytest.mark.parametrize("load", ["ramp-dwell", "monotonic"])
def test_amplitude_and_steps_are_those_of_the_programme(load: str, files: dict[str, str]) -> None:
    text = files[f"c3d8_{load.replace('-', '_')}.inp"]
    programme = load_programme(load, 15.0)
    amplitude = next(entry for entry in read(text) if entry.name == "AMPLITUDE")
    values = [float(value) for _, fields in amplitude.data for value in fields if value]
    assert values[::2] == pytest.approx(programme.times)
    assert values[1::2] == pytest.approx(programme.pressures)
    durations = [float(entry.data[0][1][1]) for entry in read(text) if entry.name == "STATIC"]
    assert durations == pytest.approx(np.diff(programme.times))
    assert len(keyword(text, "DLOAD")) == 1


PLANTED = [
    ("*USER MATERIAL, CONSTANTS=17", "*USER MATERIAL, CONSTANTS=16", "CONSTANTS=16, but 17 are given"),
    ("*STATIC", "*STATICS", "*STATICS is no keyword in use"),
    ("*DLOAD, AMPLITUDE=PLATE", "*DLOAD, AMPLITUDE=PLATES", "the amplitude 'PLATES' is not defined above"),
    ("NLGEOM=YES", "NLGEOM=MAYBE", "*STEP, NLGEOM=MAYBE: use one of YES, NO"),
    ("MATERIAL=PLY,", "MATERIAL=PLYS,", "the material 'PLYS' is not defined above"),
    ("EDGELOW, 2, 2, 0.0", "EDGE, 2, 2, 0.0", "the nset 'EDGE' is not defined above"),
    ("TYPE=C3D8,", "TYPE=C3D9,", "*ELEMENT, TYPE=C3D9: use one of"),
    ("1, 1, 2, 4, 3, 5, 6, 8, 7", "1, 1, 2, 4, 3, 5, 6, 8", "element 1 has 7 nodes, its type 8"),
    ("1, 1, 2, 4, 3, 5, 6, 8, 7", "1, 1, 2, 4, 3, 5, 6, 8, 99", "node 99 of element 1 is not defined"),
    ("15.0, 0.5, 4294.0", "15.0, O.5, 4294.0", "'O.5' in a line of *USER MATERIAL is no number"),
    ("15.0, 0.5, 4294.0", "15.0, 0.5000000000000000000, 4294.0", "has 21 characters, a number at most 20"),
    ("*END STEP\n** LOAD2", "** LOAD2", "*STEP belongs into the model, here is the step"),
    ("*DEPVAR", "*HEADING\nnothing\n*DEPVAR", "*DEPVAR has to follow *MATERIAL"),
    ("8, DISSIPATION,", "9, DISSIPATION,", "state variable 9 of 8"),
    ("0.0, 0.0, 1.0, 0.0888", "0.0, 0.0, -1.0, 0.0888", "does not come after"),
    ("*HEADING\nC3D8:", "*HEADING\n\nC3D8:", "an empty line"),
    ("10000, EXTRAPOLATION=NO", "10000, EXTRAPOLATION=NONE", "*STEP, EXTRAPOLATION=NONE: use one of LINEAR"),
    (", UNSYMM", ", UNSYMM=YES", "*USER MATERIAL, UNSYMM takes no value"),
    ("*MATERIAL, NAME=PLY", "*MATERIAL", "*MATERIAL needs the parameter NAME"),
    ("PLY1, P2, 1.0", "PLY1, P2", "2 fields in a line of *DLOAD; 3 to 3 are due"),
]


@pytest.mark.parametrize(("right", "wrong", "what"), PLANTED)
def test_a_planted_error_is_found(right: str, wrong: str, what: str, files: dict[str, str]) -> None:
    text = files["c3d8_ramp_dwell.inp"]
    assert right in text
    found = [str(problem) for problem in problems(text.replace(right, wrong, 1))]
    assert any(what in problem for problem in found), found
    with pytest.raises(InputError, match=r"planted\.inp, line \d+"):
        require_valid(text.replace(right, wrong, 1), "planted.inp")


def test_a_missing_end_of_the_last_step_is_found(files: dict[str, str]) -> None:
    text = files["c3d8_monotonic.inp"].rstrip().removesuffix("*END STEP")
    assert "the last *STEP has no *END STEP" in [problem.what for problem in problems(text)]


def test_the_readme_says_what_to_expect_and_what_was_not_run(files: dict[str, str]) -> None:
    text = files["README.txt"]
    assert "None of these has been run in Abaqus" in text
    assert re.search(r"ramp-dwell +thickness ratio 0\.6\d+, width ratio 1\.06\d+", text)
    assert "gamma_lock = 80 deg" in text
    assert "EXTRAPOLATION=NO" in text
    assert max(len(line) for line in text.split("6 What the numbers rest on")[0].splitlines()) <= 135
    assert "When it does not converge" in text
    assert all(re.search(rf"SDV{i} +SDV_", text) for i in range(1, 9))


def test_every_step_goes_without_extrapolation(files: dict[str, str]) -> None:
    for name, text in files.items():
        if name.endswith(".inp"):
            assert {step["EXTRAPOLATION"] for step in keyword(text, "STEP")} == {"NO"}, name


@pytest.mark.parametrize(
    ("scene", "what"),
    [
        ("stressonly", "no tangent"),
        ("baked", "has its constants in its source, the decks carry them in *USER MATERIAL"),
        ("lean", "choose a scene that reads PROPS, for example default"),
        ("printed", "no derivative at F = I"),
        ("free", "choose fibre '1'"),
        ("inplane", "choose fibre '3'"),
    ],
)
def test_a_scene_that_the_decks_do_not_fit_is_refused(scene: str, what: str) -> None:
    with pytest.raises(InputError, match=re.escape(what)):
        abaqus_files(scene, CASE)


def test_a_printed_scene_beside_the_first_is_refused_too() -> None:
    with pytest.raises(InputError, match="'printed' cannot start a job"):
        abaqus_files("default", CASE, ["printed"])


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


def test_the_readme_names_the_source_of_every_deck(files: dict[str, str]) -> None:
    lines = re.findall(r"^    (\S+\.for) for (.*)$", files["README.txt"], re.MULTILINE)
    patterns = {source: text.split(", ") for source, text in lines}
    assert set(patterns) == {"default.for", "default_p.for"}
    for name in (name[:-4] for name in files if name.endswith(".inp")):
        fitting = [source for source, some in patterns.items() if any(fnmatch(name, one) for one in some)]
        assert len(fitting) == 1, name
        assert f"** abaqus job={name} user={fitting[0]} interactive" in files[f"{name}.inp"]


def test_the_readme_of_a_plane_scene_has_one_source_to_name() -> None:
    assert "Each source fits its own jobs only" not in abaqus_files("plane", CASE)["README.txt"]


def test_the_readme_of_a_blend_says_how_much_too_wide_it_ends(files: dict[str, str]) -> None:
    law, offset = (
        float(found[1])
        for pattern in (r"ramp-dwell +thickness ratio \S+, width ratio ([\d.]+\d)", r"ends about (\S+) above these values")
        if (found := re.search(pattern, abaqus_files("blend", CASE)["README.txt"]))
    )
    for scene, expected in (("blend", offset), ("default", 0.0)):
        width = run_case(CASE, prepare_umat(scene)).summary()["width_ratio_final"]
        assert width - law == pytest.approx(expected, abs=0.3 * offset)
    assert "above these values" not in files["README.txt"]
    assert "about +4e-4 of w0 for blend_width = 1e-3" in files["README.txt"]


def test_a_temperature_outside_the_table_is_taken_when_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["abaqus", "--material", "IM7-8552", "--temperature", "95", "-o", str(tmp_path)]
    assert main(command) == 2
    assert "--extrapolate" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert main([*command, "--extrapolate"]) == 0
    assert "IM7-8552 at 95 degC" in (tmp_path / "README.txt").read_text()


@pytest.mark.parametrize("value", ["nan", "inf"])
def test_a_temperature_that_is_no_number_is_refused(
    value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["abaqus", "--material", "IM7-8552", "--extrapolate", "-o", str(tmp_path), "--temperature", value]
    assert main(command) == 2
    assert f"--temperature {value}: give a finite number in degC" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_plane_scene_gets_the_plane_jobs() -> None:
    files = abaqus_files("plane", CASE)
    assert {name for name in files if name.endswith(".inp")} == {
        f"{element}_{load}.inp" for element in ("cpe4", "cax4") for load in ("ramp_dwell", "monotonic")
    }


def test_the_command_writes_the_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["abaqus", "default", "--material", "IM7-8552", "--set", "kappa=1000", "-o", str(tmp_path)]) == 0
    printed = capsys.readouterr().out.split()
    assert {Path(path).name for path in printed} == {path.name for path in tmp_path.iterdir()}
    assert "15 kappa = 1000.0 [MPa]" in (tmp_path / "c3d8_monotonic.inp").read_text()


def test_other_scenes_come_in_one_source_with_a_card_each(tmp_path: Path) -> None:
    arguments = ["default", "--material", "IM7-8552", "--also", "blend", "--also", "plane", "--aba-param"]
    assert main(["abaqus", *arguments, "-o", str(tmp_path)]) == 0
    source, cards = (tmp_path / "together.for").read_text(), (tmp_path / "together_materials.inp").read_text()
    assert [entry["NAME"] for entry in keyword(cards, "MATERIAL")] == ["DEFAULT", "BLEND", "PLANE"]
    assert source.count("SUBROUTINE UMAT(") == 1
    assert source.count("INCLUDE 'ABA_PARAM.INC'") == 4
    assert "together_materials.inp" in (tmp_path / "README.txt").read_text()


def test_a_scene_with_a_temperature_table_gets_the_temperature() -> None:
    files = abaqus_files("table", CASE)
    for name in ("c3d8_ramp_dwell.inp", "cpe4_monotonic.inp", "laminate.inp"):
        given = next(entry for entry in read(files[name]) if entry.name == "INITIAL CONDITIONS")
        assert given.data[0][1] == ["NALL", "70.0"]
        wrong = files[name].replace("NALL, 70.0", "EVERYWHERE, 70.0")
        assert any("the nset 'EVERYWHERE' is not defined" in problem.what for problem in problems(wrong))
    assert "*TEMPERATURE" in files["README.txt"]


def test_without_a_table_no_temperature_is_given(files: dict[str, str]) -> None:
    assert not any("INITIAL CONDITIONS" in text for name, text in files.items() if name.endswith(".inp"))


def test_two_scenes_of_one_name_in_one_source_are_refused() -> None:
    with pytest.raises(InputError, match="2 scenes are called 'default'"):
        abaqus_files("default", CASE, ["default"])


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


def test_a_card_with_too_few_values_is_refused() -> None:
    rows = [{"index": 1, "name": "a", "unit": "-", "meaning": "a"}]
    with pytest.raises(InputError, match="0 values for 1 constants"):
        MaterialCard("M", [], rows, [], False).text("abaqus")
