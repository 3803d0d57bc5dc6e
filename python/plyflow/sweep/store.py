"""The folder of a sweep: finished parts, the result made of them, what it was made with.

A file is written within the folder of the parts and then renamed to its place, so it is whole or absent.
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import Any

import pyarrow.compute as pc
import pyarrow.parquet as pq

from plyflow.case.assumptions import default_assumptions
from plyflow.case.materials import INTERPOLATION
from plyflow.errors import InputError, OutputError
from plyflow.files import require_writable, write_files
from plyflow.sweep.axes import NUMBER_NAMES, TEXT_NAMES
from plyflow.sweep.parts import result_schema
from plyflow.sweep.plan import Plan

RESULT, TABLE, RECORD, LOCK = "result.parquet", "result.csv", "sweep.json", ".sweep.lock"
MOST_EXAMPLES = 5
LIBRARIES = ("numpy", "pandas", "pyarrow", "dask")
COLUMNS = {
    "case": "number of the case in the list, from 1",
    "status": "done or failed",
    "reason": "why a case failed",
    "thickness_ratio": "h/h0 at the end of the load",
    "thickness_mm": "thickness of the specimen of 16 plies at the end [mm]",
    "thickness_ratio_limit": "h/h0 at the compaction limit",
    "width_ratio": "w/w0 at the end",
    "width_mm": "width at the end [mm]",
    "fibre_fraction": "fibre volume fraction at the end",
    "lock_time_s": "time at which the ply locks [s], empty if it does not",
    "eps_lock": "compaction at locking (Eq. 6)",
    "*_1d": "the same by the one-dimensional law",
    "increments, iterations, cutbacks": "of the driver, or of the laminate",
    "width_ratio_inner, width_ratio_outer": "laminate: of the innermost and of the outermost blocks; width_ratio is the mean",
    "lock_time_last_s, locked_share": "laminate: when its last point locks [s], share that did; lock_time_s is the first",
    "times_s, thickness_ratios": "laminate: h/h0 over time",
}


class Store:
    """Folder of one plan."""

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

    def begin(self, overwrite: bool) -> Mapping[str, Any] | None:
        """Take the folder for this plan; its record if the result is there and whole, else None.

        Raises
        ------
        InputError
            It holds another sweep, and that is not to be overwritten.
        """
        record = self._record()
        if record and record.get("key") != self._key:
            if not overwrite:
                raise InputError(
                    f"{self.folder} holds another sweep ({record.get('key')}, this is {self._key}): choose another "
                    "folder with -o, or discard it with --overwrite"
                )
            for name in (RECORD, RESULT, TABLE):
                (self.folder / name).unlink(missing_ok=True)
            record = {}
        whole = _failed_in(self.folder / RESULT, len(self._plan.source)) is not None and (self.folder / TABLE).is_file()
        complete = record if record.get("complete") and whole else None
        for other in self.folder.glob("parts-*"):
            if complete or other != self._parts:
                shutil.rmtree(other)
        if complete is None:
            self._parts.mkdir(exist_ok=True)
            if not record:
                self._write_record(None)
        return complete

    def done(self) -> dict[int, int]:
        """Parts that are there and whole, and how many of their cases failed."""
        counts = {number: _failed_in(self._path(number), size) for number, size in enumerate(self._plan.sizes)}
        return {number: failed for number, failed in counts.items() if failed is not None}

    def write(self, number: int, content: bytes) -> None:
        """Keep a finished part."""
        try:
            with self._replacing(self._path(number)) as temporary:
                temporary.write_bytes(content)
        except OSError as error:
            raise OutputError(f"cannot write into {self.folder}: {error.strerror}: what is done stays") from error

    def finish(self) -> Mapping[str, Any]:
        """Join the parts into result.parquet and result.csv, record, remove the parts; one part at a time in memory."""
        inputs = json.dumps(self._plan.inputs(), sort_keys=True)
        schema = result_schema(self._plan.columns, self._plan.model).with_metadata({"plyflow": inputs})
        counts: dict[str, Any] = {"failed": 0, "examples": []}
        with (
            self._replacing(self.folder / TABLE) as text,
            self._replacing(self.folder / RESULT) as binary,
            pq.ParquetWriter(binary, schema) as writer,
            text.open("w", encoding="utf-8", newline="") as stream,
        ):
            for number in range(len(self._plan.sizes)):
                table = pq.read_table(self._path(number))
                writer.write_table(table.cast(schema))
                table.to_pandas().to_csv(stream, index=False, header=number == 0, lineterminator="\n")
                failures = table.select(["case", "reason"]).filter(pc.equal(table["status"], "failed"))
                counts["failed"] += failures.num_rows
                counts["examples"] += failures.slice(0, MOST_EXAMPLES - len(counts["examples"])).to_pylist()
        record = self._write_record(counts)
        shutil.rmtree(self._parts)
        return record

    def _path(self, number: int) -> Path:
        return self._parts / f"part-{number:06d}.parquet"

    @contextmanager
    def _replacing(self, path: Path) -> Iterator[Path]:
        """A temporary path whose file, flushed to disk, takes the place of `path` when all went well."""
        temporary = self._parts / f".{path.name}"
        yield temporary
        with temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        os.replace(temporary, path)

    def _record(self) -> dict[str, Any]:
        """The record in the folder, empty if there is none."""
        try:
            return dict(json.loads((self.folder / RECORD).read_text(encoding="utf-8")))
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            raise InputError(f"{self.folder / RECORD} is no record of a sweep ({error}): choose -o") from error

    def _write_record(self, counts: Mapping[str, Any] | None) -> dict[str, Any]:
        record = sweep_record(self._plan, self._key, counts)
        write_files(self.folder, {RECORD: json.dumps(record, indent=2) + "\n"})
        return record


def sweep_record(plan: Plan, key: str, counts: Mapping[str, Any] | None) -> dict[str, Any]:
    """Plain data of a sweep, begun (no counts) or complete: inputs, assumptions, tools.

    It holds no times, so that equal sweeps have equal records.
    """
    varied = plan.source.columns
    return {
        "key": key,
        "complete": counts is not None,
        "cases": len(plan.source),
        **(counts or {}),
        "inputs": plan.inputs(),
        "defaults": {name: value for name, value in plan.defaults.items() if name not in varied},
        "assumptions": [
            *(str(entry) for name, entry in default_assumptions().items() if name not in varied),
            *(f"{name}: a column of the table" for name in plan.columns if name not in (*TEXT_NAMES, *NUMBER_NAMES)),
            f"material parameters: between the columns of the material's table by {INTERPOLATION}"
            + (", straight on outside them" if plan.extrapolate else ", refused outside them"),
            "eps_lock by Eq. 6 unless it is a column; a block of equal plies acts as one ply",
            "plate pressure = force / (width x width); fibre inextensible, edge free",
        ],
        "columns": COLUMNS,
        "libraries": {name: metadata.version(name) for name in LIBRARIES},
    }


def _failed_in(path: Path, cases: int) -> int | None:
    """Number of failed cases in a Parquet file, None if it is missing or does not hold all cases."""
    try:
        status = pq.read_table(path, columns=["status"])["status"]
    except (OSError, ValueError):  # pyarrow's own errors derive from these
        return None
    return int(pc.sum(pc.equal(status, "failed")).as_py() or 0) if len(status) == cases else None
