"""What CalculiX writes: the printed tables (.dat) and the table of increments (.sta)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from plyflow.errors import RunError

Array = NDArray[np.float64]
TITLES = {
    "displacements (vx,vy,vz)": "U",
    "forces (fx,fy,fz)": "RF",
    "total force (fx,fy,fz)": "TOTAL",
    "stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz)": "S",
    "internal state variables (elem, integ.pnt.,values)": "SDV",
}
_KEY_COLUMNS = {"U": 1, "RF": 1, "TOTAL": 0, "S": 2, "SDV": 2}
_HEAD = re.compile(r"^ (.+) for set (\S+) and time +(\S+)\s*$")
_NUMBER = re.compile(r"[-+]?\d+\.\d*(?:[EeDd][-+]?\d+|[-+]\d{3})?|[-+]?\d+|[-+]?(?:NaN|Infinity)")
_BARE_EXPONENT = re.compile(r"(?<=\d)(?=[-+]\d{3}$)")


@dataclass(frozen=True)
class Table:
    """One printed quantity of one set over time.

    Parameters
    ----------
    time : (n,) total time in s.
    keys : node, or element and integration point, of each row.
    values : (n, rows, columns).
    """

    time: Array
    keys: tuple[tuple[int, ...], ...]
    values: Array

    def of(self, *key: int) -> Array:
        """(n, columns) of one node or integration point.

        Raises
        ------
        KeyError
            It is not in the table.
        """
        if key not in self.keys:
            raise KeyError(f"{key} is not printed; printed are {self.keys[0]} to {self.keys[-1]}")
        return np.asarray(self.values[:, self.keys.index(key)])


def read_tables(path: Path) -> dict[tuple[str, str], Table]:
    """Tables of a .dat file by (quantity, set); quantities U, RF, TOTAL, S, SDV, lengths mm, forces N, stress MPa.

    Raises
    ------
    RunError
        The file is missing or cannot be read.
    """
    found: dict[tuple[str, str], list[tuple[float, list[list[float]]]]] = {}
    rows: list[list[float]] = []
    for line in _lines(path):
        head = _HEAD.match(line)
        if head:
            rows = []
            title = TITLES.get(head[1].strip())
            if title:
                found.setdefault((title, head[2]), []).append((_number(head[3]), rows))
        elif line[:1] == " " and line.strip()[:1].isalpha():
            rows = []
        elif line.strip():
            rows.append([_number(text) for text in _NUMBER.findall(line)])
    return {key: _table(key[0], blocks) for key, blocks in found.items()}


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(errors="replace").splitlines()
    except OSError as error:
        raise RunError(f"CalculiX wrote no {path.name}: {error.strerror}; look into its log beside it") from error


def _number(text: str) -> float:
    """A Fortran number; an exponent of three digits comes without its letter."""
    return float(_BARE_EXPONENT.sub("E", text.replace("D", "E").replace("d", "e")))


def _table(kind: str, blocks: list[tuple[float, list[list[float]]]]) -> Table:
    keyed = _KEY_COLUMNS[kind]
    first = blocks[0][1]
    keys = tuple(tuple(int(value) for value in row[:keyed]) for row in first)
    values = [[row[keyed:] for row in rows] for _, rows in blocks]
    return Table(np.array([time for time, _ in blocks]), keys, np.array(values))


def read_increments(path: Path) -> pd.DataFrame:
    """Table of increments: step, increment, attempt, failed, iterations, total_time, step_time, increment_size [s].

    Raises
    ------
    RunError
        The file is missing.
    """
    rows = []
    for line in _lines(path)[2:]:
        fields = line.split()
        if len(fields) == 7:
            counts = [int(fields[0]), int(fields[1]), int(fields[2].rstrip("U")), fields[2].endswith("U")]
            rows.append([*counts, int(fields[3]), *(float(text) for text in fields[4:])])
    names = ["step", "increment", "attempt", "failed", "iterations", "total_time", "step_time", "increment_size"]
    return pd.DataFrame(rows, columns=names)
