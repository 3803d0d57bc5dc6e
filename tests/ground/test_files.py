"""All files of a call are written, or none."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from plyflow import files
from plyflow.errors import OutputError
from plyflow.files import write_files


def test_files_are_written_whole_and_nothing_else_is_left(tmp_path: Path) -> None:
    written = write_files(tmp_path / "new", {"a.txt": "one\n", "deep/b.txt": "two\n"})
    assert [path.read_text() for path in written] == ["one\n", "two\n"]
    assert {path.name for path in (tmp_path / "new").rglob("*")} == {"a.txt", "deep", "b.txt"}


def test_data_become_json_and_tables_csv(tmp_path: Path) -> None:
    table = pd.DataFrame({"time_s": [0.0, 1.0], "stage": ["squeeze", "bleed"]})
    data, csv = write_files(tmp_path, {"a.json": {"k": [0.1, None]}, "a.csv": table})
    assert data.read_text() == '{\n  "k": [\n    0.1,\n    null\n  ]\n}\n'
    assert csv.read_text() == "time_s,stage\n0.0,squeeze\n1.0,bleed\n"
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_files(tmp_path, {"b.txt": "text", "b.json": {"k": float("nan")}})
    assert {path.name for path in tmp_path.iterdir()} == {"a.json", "a.csv"}


def check_nothing_changed(folder: Path) -> None:
    assert [path.name for path in folder.iterdir()] == ["a.txt"]
    assert (folder / "a.txt").read_text() == "old"


def test_when_the_second_file_fails_the_first_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.txt").write_text("old")
    stage = files._stage

    def disk_full(target: Path, text: str) -> Path:
        if target.name == "b.txt":
            raise OSError(28, "No space left on device")
        return stage(target, text)

    monkeypatch.setattr(files, "_stage", disk_full)
    with pytest.raises(OutputError, match=r"No space left on device; choose another place"):
        write_files(tmp_path, {"a.txt": "new", "b.txt": "new"})
    check_nothing_changed(tmp_path)
    (tmp_path / "a.txt").write_text("new")
    with pytest.raises(AssertionError):  # a changed first file is noticed
        check_nothing_changed(tmp_path)


def test_a_folder_where_a_file_should_go_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(OutputError, match=r"a\.txt is a folder"):
        write_files(tmp_path, {"a.txt": "text"})
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("folder", ["afile", "afile/deeper"])
def test_a_file_where_a_folder_should_be_is_named(tmp_path: Path, folder: str) -> None:
    in_the_way = tmp_path / "afile"
    in_the_way.write_text("kept")
    with pytest.raises(OutputError, match=r"afile is a file, not a folder; choose another place$"):
        write_files(tmp_path / folder, {"a.txt": "text"})
    in_the_way.unlink()
    assert write_files(tmp_path / folder, {"a.txt": "text"})[0].read_text() == "text"
