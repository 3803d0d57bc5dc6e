"""A failed increment leaves a file behind, and one command repeats exactly that increment."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from plyflow.case.case import Case
from plyflow.cli import main
from plyflow.errors import InputError, RunError
from plyflow.run.case_run import case_controls, run_case
from plyflow.run.replay import replay_file
from plyflow.umat.prepare import Umat, generate_scene, prepare_umat

CASE = Case("IM7-8552", 70.0, "BP", 15.0)
HOPELESS = replace(case_controls(), max_iterations=1, max_attempts=1)
RUN = ["run", "--material", "IM7-8552", "--temperature", "70", "--layup", "BP"]


@pytest.fixture
def failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Path:
    """Replay file of a run with the printed invariants, which have no derivative at F = I."""
    monkeypatch.chdir(tmp_path)
    assert main([*RUN, "--scene", "printed"]) == 2
    message = capsys.readouterr().err
    assert "plyflow replay failed-increment.txt" in message
    return tmp_path / "failed-increment.txt"


def test_a_failed_run_leaves_the_increment_and_replay_repeats_it(
    failed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(failed)]) == 1
    told = capsys.readouterr().out
    assert "the printed invariants are not real here, or have no derivative" in told
    assert "it fails again: step 1, increment 1 at total time 0.00000E+00 s, size 3.906E-05 s" in told


def test_another_umat_goes_through_where_the_printed_form_fails(
    failed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, scene = tmp_path / "bdf1.for", tmp_path / "mine.toml"
    source.write_text(generate_scene("bdf1")[0])
    scene.write_text('tangent = "symmetric"\nintegrator = "bdf1"\n')
    for umat in (str(source), str(scene), "bdf1"):
        assert main(["replay", str(failed), "--umat", umat]) == 0
        assert "it goes through here" in capsys.readouterr().out


def test_the_file_outlives_the_cache(failed: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The library is gone; the source beside the file is the same UMAT."""
    again = replay_file(failed)
    failed.write_text(failed.read_text().replace(str(again.library), "/gone/umat.so"))
    assert failed.with_suffix(".for").read_text() == prepare_umat("printed").source
    assert replay_file(failed).history.message == again.history.message
    failed.with_suffix(".for").unlink()
    with pytest.raises(InputError, match="which is not there; name another with --umat"):
        replay_file(failed)


def test_the_advice_of_a_run_names_what_it_has_an_option_for(umat: Umat) -> None:
    with pytest.raises(RunError, match="--refine 10") as stopped:
        run_case(CASE, umat, HOPELESS)
    assert "allow more" not in str(stopped.value) and "minimum_increment" not in str(stopped.value)


def test_a_run_that_ends_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*RUN, "--json"]) == 0
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_hides_no_reason(umat: Umat, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(RunError, match=r"iterations.*the increment is not kept: cannot write into"):
        run_case(CASE, umat, HOPELESS, blocked / "kept.txt")


def test_the_replayed_state_is_that_of_the_failure(umat: Umat, tmp_path: Path) -> None:
    """Stopped in the middle of the programme: the file holds the converged state, and a planted other one is seen."""
    file = tmp_path / "kept.txt"
    with pytest.raises(RunError, match=r"plyflow replay .*kept\.txt"):
        run_case(CASE, umat, HOPELESS, file)
    whole = run_case(CASE, umat).history
    start = replay_file(file).history
    row = int(np.argmin(np.abs(whole.time - start.time[0])))
    assert whole.time[row] == pytest.approx(start.time[0], rel=1e-12)
    np.testing.assert_allclose(start.deformation_gradient[0], whole.deformation_gradient[row], atol=1e-6)
    assert not replay_file(file).history.completed
    more = file.read_text().replace("max_iterations = 1\n", "max_iterations = 16\n")
    file.write_text(more)
    assert replay_file(file).history.completed


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "is no file"),
        ("begin step\nend step\n", "no line 'library"),
        ("library = ./gone.so\n", "gone.so, which is not there"),
        ("library = {library}\nnonsense = 1\n", "nonsense"),
    ],
)
def test_what_is_no_replay_file_is_refused(umat: Umat, tmp_path: Path, text: str | None, message: str) -> None:
    file = tmp_path / "case.txt"
    if text is not None:
        file.write_text(text.format(library=umat.library.path))
    with pytest.raises(InputError, match=message) as refused:
        replay_file(file)
    assert str(file) in str(refused.value)


def test_the_prepared_printed_scene_is_the_one_that_failed(failed: Path) -> None:
    assert replay_file(failed).library == Path(prepare_umat("printed").library.path).resolve()
