"""A good UMAT passes every check of the examination; each mistake, planted into it, is found by the check that looks for it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.diagnose.case import programme
from plyflow.diagnose.check import diagnose
from plyflow.diagnose.examine import Verdict, examine
from plyflow.diagnose.library import load_umat
from plyflow.diagnose.statics import Statics
from plyflow.umat.library import UmatLibrary
from plyflow.umat.prepare import prepare_umat

SOURCE = Path(__file__).parent / "umats" / "neo_hooke.f"
GOOD, CONSTANTS = "      LOGICAL JAUMANN\n", [1.3, 4.1, 0.0]
PAUSE = """INTERFACE
        FUNCTION PAUSE(MICROSECONDS) BIND(C, NAME='usleep')
          INTEGER, VALUE :: MICROSECONDS
          INTEGER :: PAUSE
        END FUNCTION
      END INTERFACE"""
# Check, declaration, statements at the end (a source's own lines where two are given), what the verdict says.
MISTAKES: dict[str, tuple[str, str, str, str]] = {
    "a stress that is not turned": (
        "objectivity", "", "STRESS(1) = STRESS(1) + 0.01D0*DFGRD1(1,2)", "bad: turned rigidly"),
    "a count that is kept": (
        "called again", "DOUBLE PRECISION, SAVE :: TALLY = 0.D0",
        "TALLY = TALLY + 1.D0\n      STRESS(1) = STRESS(1)*(1.D0 + 1.D-9*TALLY)", "bad: 10 of 10 increments"),
    "the same by name": (
        "SAVE and COMMON", "DOUBLE PRECISION, SAVE :: TALLY = 0.D0", "TALLY = TALLY + 1.D0", "bad: calls write SAVE TALLY"),
    # Some calls sleep between write and read: two threads meet there for certain, however busy the machine.
    "a scratch variable in COMMON": (
        "two threads", f"{PAUSE}\n      COMMON /WORK/ SCRATCH\n      VOLATILE SCRATCH",
        "SCRATCH = S(1,1)\n      IF (MOD(NOEL,400) .EQ. 2) I = PAUSE(2000)\n      STRESS(1) = SCRATCH", "bad: on two threads"),
    "COMMON by name": (
        "SAVE and COMMON", "COMMON /WORK/ SCRATCH", "SCRATCH = S(1,1)", "bad: calls write COMMON or module variable WORK"),
    "the longest increment so far, kept": (
        "after a cutback", "DOUBLE PRECISION, SAVE :: TOP = 0.D0",
        "TOP = MAX(TOP, DTIME)\n      STRESS(2) = STRESS(2) + 1.D-3*TOP", "bad: half an increment"),
    "a refusal after the stress": ("failure", "", "IF (AJ .LE. 0.D0) PNEWDT = 0.25D0", "bad: at det F < 0 it refuses"),
    "no look at the volume": (
        "failure", "      AL = PROPS(2)*LOG(AJ)\n", "      AL = PROPS(2)*LOG(ABS(AJ))\n", "look: a deformation that is turned"),
    "NaN swallowed": ("NaN in", "", "STRESS = MAX(STRESS, -1.D30)", "bad: NaN in DFGRD1"),
}  # fmt: skip


def verdicts_of(library: UmatLibrary, props: list[float], case: str = "general", n_statev: int = 0) -> dict[str, Verdict]:
    chosen = programme(case, props, n_statev)
    return {verdict.check: verdict for verdict in examine(library, chosen, diagnose(library, chosen))}


def altered(folder: Path, declared: str, done: str) -> UmatLibrary:
    text = SOURCE.read_text()
    if declared.endswith("\n"):
        assert text.count(declared) == 1
        text = text.replace(declared, done)
    else:
        text = text.replace(GOOD, f"{GOOD}      {declared}\n" if declared else GOOD, 1)
        text = text.replace("      RETURN\n", f"      {done}\n      RETURN\n", 1)
    (folder / "altered.f").write_text(text)
    return load_umat(folder / "altered.f")


def test_a_good_umat_passes_every_check(neo_hooke: UmatLibrary) -> None:
    verdicts = verdicts_of(neo_hooke, CONSTANTS)
    assert len(verdicts) == 10
    assert {verdict.outcome for verdict in verdicts.values()} == {"good"}


@pytest.mark.parametrize("scene", ["default", "bdf1"])
def test_the_emitted_umat_passes_every_check(scene: str) -> None:
    umat = prepare_umat(scene)
    props = [float(row["default"]) for row in umat.manifest["props"]]
    verdicts = verdicts_of(umat.library, props, n_statev=len(umat.manifest["statev"]))
    assert {check for check, verdict in verdicts.items() if verdict.outcome != "good"} == {"PROPS"}
    # The path does not reach the lock: l0_over_d and b_bleed wait.
    assert verdicts["PROPS"].found == "PROPS 3, 7: without effect on this path"


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_planted_mistake_is_found_with_what_to_do(mistake: str, tmp_path: Path) -> None:
    check, declared, done, said = MISTAKES[mistake]
    verdict = verdicts_of(altered(tmp_path, declared, done), CONSTANTS)[check]
    assert f"{verdict.outcome}: {verdict.found}".startswith(said)
    assert verdict.remedy


def test_a_law_without_a_potential_makes_energy(neo_hooke: UmatLibrary) -> None:
    """A pressure that grows with b11: the right tangent of a stress that no potential has."""
    verdict = verdicts_of(neo_hooke, [1.3, 4.1, 15.0])["energy"]
    assert (verdict.outcome, verdict.found[:28]) == ("bad", "a closed cycle gives back 0.")


def test_a_constant_that_nobody_reads_is_named(neo_hooke: UmatLibrary) -> None:
    verdict = verdicts_of(neo_hooke, [*CONSTANTS, 7.0, 0.0])["PROPS"]
    assert (verdict.outcome, verdict.found) == ("look", "PROPS 4, 5: without effect on this path")


def test_what_is_only_read_is_no_mistake(neo_hooke: UmatLibrary) -> None:
    """One of the source's DATA is not folded away by the compiler; it is there, and is not written."""
    assert len(Statics(neo_hooke).found) == 1
    assert "1 that are only read (DATA)" in verdicts_of(neo_hooke, CONSTANTS)["SAVE and COMMON"].found


def test_without_readelf_it_is_open(neo_hooke: UmatLibrary, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("plyflow.diagnose.statics.shutil.which", lambda name: None)
    assert verdicts_of(neo_hooke, CONSTANTS)["SAVE and COMMON"].outcome == "open"


def test_the_command_shows_the_verdicts_and_writes_json_and_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["drive", str(SOURCE), "general", "--props", "1.3,4.1,15"]
    assert main([*arguments, "--html", str(tmp_path / "page.html")]) == 1
    said = capsys.readouterr().out
    assert "DDSDDE is right" in said
    assert "objectivity" in said
    written = (tmp_path / "page.html").read_text()
    assert "Examination of neo_hooke.f" in written
    assert "derive the elastic stress from one potential" in written
    assert main([*arguments, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert {one["check"]: one["outcome"] for one in found["verdicts"]}["energy"] == "bad"
    assert found["tangent_right"] is True
