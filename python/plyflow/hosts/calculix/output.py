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
# Title in the .dat file: name of the quantity, columns before its values.
TITLES = {
    "displacements (vx,vy,vz)": ("U", 1),
    "forces (fx,fy,fz)": ("RF", 1),
    "total force (fx,fy,fz)": ("TOTAL", 0),
    "stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz)": ("S", 2),
    "internal state variables (elem, integ.pnt.,values)": ("SDV", 2),
}
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
    found: dict[tuple[str, str, int], list[tuple[float, list[list[float]]]]] = {}
    rows: list[list[float]] = []
    for line in _lines(path):
        head = _HEAD.match(line)
        if head or line.strip()[:1].isalpha():
            rows = []
        elif line.strip():
            rows.append([_number(text) for text in _NUMBER.findall(line)])
        if head and head[1].strip() in TITLES:
            quantity, keyed = TITLES[head[1].strip()]
            found.setdefault((quantity, head[2], keyed), []).append((_number(head[3]), rows))
    return {(quantity, where): _table(keyed, blocks) for (quantity, where, keyed), blocks in found.items()}


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(errors="replace").splitlines()
    except OSError as error:
        raise RunError(f"CalculiX wrote no {path.name}: {error.strerror}; look into its log beside it") from error


def _number(text: str) -> float:
    """A Fortran number; an exponent of three digits comes without its letter."""
    return float(_BARE_EXPONENT.sub("E", text.replace("D", "E").replace("d", "e")))


def _table(keyed: int, blocks: list[tuple[float, list[list[float]]]]) -> Table:
    keys = tuple(tuple(int(value) for value in row[:keyed]) for row in blocks[0][1])
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
            attempt = fields[2]
            counts = [int(fields[0]), int(fields[1]), int(attempt.rstrip("U")), attempt.endswith("U"), int(fields[3])]
            rows.append([*counts, *map(float, fields[4:])])
    names = ["step", "increment", "attempt", "failed", "iterations", "total_time", "step_time", "increment_size"]
    return pd.DataFrame(rows, columns=names)
