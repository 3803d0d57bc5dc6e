"""The folder of a sweep: finished parts, whole or absent; the result made of them; what it was made with."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from plyflow.errors import InputError, OutputError
from plyflow.files import require_writable, write_files
from plyflow.sweep.parts import result_schema
from plyflow.sweep.plan import Plan

RESULT, TABLE, RECORD, LOCK = "result.parquet", "result.csv", "sweep.json", ".sweep.lock"
MOST_EXAMPLES = 5


class Store:
    """Folder of one plan. Every file is written under another name, flushed to disk, then renamed."""

    def __init__(self, folder: Path, plan: Plan) -> None:
        self.folder = folder
        self._plan = plan
        self._key = plan.key()
        self._parts = folder / f"parts-{self._key[:16]}"

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder for one process; the system lets go of it when the process ends, however it ends.

        Raises
        ------
        OutputError
            The folder cannot be written, or another sweep is writing into it.
        """
        require_writable(self.folder)
        path = self.folder / LOCK
        with path.open("w") as stream:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise OutputError(f"another sweep is writing into {self.folder}: wait, or choose -o") from error
            try:
                yield
            finally:
                path.unlink(missing_ok=True)

    def begin(self, overwrite: bool) -> None:
        """Take the folder for this plan; leftovers of a killed run are removed.

        Raises
        ------
        InputError
            It holds another sweep, and that is not to be overwritten.
        """
        record = self._record()
        if record is not None and record.get("key") != self._key:
            if not overwrite:
                raise InputError(
                    f"{self.folder} holds another sweep ({record.get('key')}, this is {self._key}): choose another "
                    "folder with -o, or discard it with --overwrite"
                )
            for name in (RECORD, RESULT, TABLE):
                (self.folder / name).unlink(missing_ok=True)
        for other in self.folder.glob("parts-*"):
            if other != self._parts:
                shutil.rmtree(other)
        self._parts.mkdir(exist_ok=True)
        for left in [*self._parts.glob(".*"), *self.folder.glob(f".{RESULT}.*"), *self.folder.glob(f".{TABLE}.*")]:
            left.unlink()
        if record is None or record.get("key") != self._key:
            self._write_record(None)

    def complete(self) -> Mapping[str, Any] | None:
        """What was recorded if the result is there and whole, else None."""
        record = self._record()
        if record is None or record.get("key") != self._key or not record.get("complete"):
            return None
        there = _rows(self.folder / RESULT) == len(self._plan.source) and (self.folder / TABLE).is_file()
        return record if there else None

    def missing(self) -> set[int]:
        """Numbers of the parts that are not there, or not whole."""
        size, total = self._plan.chunk_size, len(self._plan.source)
        sizes = {number: min(size, total - number * size) for number in range(self._plan.chunks)}
        return {number for number, rows in sizes.items() if _rows(self._path(number)) != rows}

    def write(self, number: int, content: bytes) -> None:
        """Keep a finished part."""
        try:
            with _replacing(self._path(number)) as temporary:
                temporary.write_bytes(content)
        except OSError as error:
            raise OutputError(f"cannot write into {self.folder}: {error.strerror}: what is done stays") from error

    def failed_before(self, missing: set[int]) -> int:
        """Failed cases among the parts that are there."""
        return sum(_count_failed(self._path(number)) for number in range(self._plan.chunks) if number not in missing)

    def finish(self) -> Mapping[str, Any]:
        """Join the parts into result.parquet and result.csv, record, remove the parts; one part at a time in memory."""
        inputs = json.dumps(self._plan.inputs(), sort_keys=True)
        schema = result_schema(self._plan.columns, self._plan.model).with_metadata({"plyflow": inputs})
        counts: dict[str, Any] = {"failed": 0, "examples": []}
        with (
            _replacing(self.folder / TABLE) as text,
            _replacing(self.folder / RESULT) as binary,
            pq.ParquetWriter(binary, schema) as writer,
            text.open("w", encoding="utf-8", newline="") as stream,
        ):
            for number in range(self._plan.chunks):
                table = pq.read_table(self._path(number))
                writer.write_table(table.cast(schema))
                frame = table.to_pandas()
                frame.to_csv(stream, index=False, header=number == 0, lineterminator="\n")
                _count(frame[frame["status"] == "failed"], counts)
        self._write_record(counts)
        shutil.rmtree(self._parts)
        record = self._record()
        assert record is not None
        return record

    def discard_parts(self) -> None:
        """Remove the parts of a sweep that is complete."""
        shutil.rmtree(self._parts, ignore_errors=True)

    def _path(self, number: int) -> Path:
        return self._parts / f"part-{number:06d}.parquet"

    def _record(self) -> dict[str, Any] | None:
        try:
            return dict(json.loads((self.folder / RECORD).read_text(encoding="utf-8")))
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise InputError(f"{self.folder / RECORD} is no record of a sweep ({error}): choose -o") from error

    def _write_record(self, counts: Mapping[str, Any] | None) -> None:
        from plyflow.sweep.record import sweep_record  # noqa: PLC0415

        text = json.dumps(sweep_record(self._plan, self._key, counts), indent=2) + "\n"
        write_files(self.folder, {RECORD: text})


@contextmanager
def _replacing(path: Path) -> Iterator[Path]:
    """A temporary path that takes the place of `path` when all went well, and goes when not."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        yield temporary
        with temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        os.replace(temporary, path)
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _rows(path: Path) -> int | None:
    """Rows of a Parquet file, None if it is missing or not whole."""
    try:
        return int(pq.read_metadata(path).num_rows)
    except (OSError, ValueError):  # pyarrow's own errors derive from these
        return None


def _count_failed(path: Path) -> int:
    status = pq.read_table(path, columns=["status"])["status"]
    return sum(value == "failed" for value in status.to_pylist())


def _count(failures: Any, counts: dict[str, Any]) -> None:
    counts["failed"] += len(failures)
    room = MOST_EXAMPLES - len(counts["examples"])
    for row in failures.head(max(room, 0)).to_dict("records"):
        counts["examples"].append({"case": row["case"], "reason": row["reason"]})
