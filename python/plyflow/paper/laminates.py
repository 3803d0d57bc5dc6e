"""Figs. 8 to 11 and the claims from finite elements: what `plyflow sweep --model laminate` has written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from plyflow.case.case import Case, all_cases
from plyflow.errors import InputError
from plyflow.law import integrate
from plyflow.paper.claims import CLAIMS, Claim, Finding, Verdict
from plyflow.paper.model import LOAD, Model
from plyflow.wording import count_text

FIGURES = ("8", "9", "10", "11")
KEYS = ["material", "temperature", "layup", "width"]
NEEDED = [*KEYS, "load", "status", "cells", "friction", "thickness_mm", "width_ratio", "width_ratio_inner", "times_s"]
MEASURED = ("thickness_mm", "width_ratio")


@dataclass(frozen=True)
class LaminateModel(Model):
    """The model as a laminate of finite elements, its cases out of the table of a sweep, the law beside them."""

    table: pd.DataFrame = field(default_factory=pd.DataFrame)
    points: pd.DataFrame = field(default_factory=lambda: pd.DataFrame(columns=[*KEYS, *MEASURED]))

    @property
    def marks(self) -> str:
        """What the marks of a figure are."""
        return "finite elements"

    @property
    def words(self) -> str:
        """How the cases were run, in a sentence."""
        cells = ", ".join(
            f"{cells:g} x {cells:g} for {' and '.join(rows['layup'].unique())}" for cells, rows in self.driven.groupby("cells")
        )
        counts, friction = self.driven["increments"], ", ".join(f"{one:g}" for one in self.driven["friction"].unique())
        return (
            f"Elements in the plane of a quarter: {cells}; one through each block; Coulomb friction {friction} at the plates; "
            f"{counts.min():.0f} to {counts.max():.0f} increments."
        )

    @property
    def measured(self) -> pd.DataFrame:
        """Measured points given."""
        return self.points

    @cached_property
    def driven(self) -> pd.DataFrame:
        """Final state of the cases that were finished."""
        done = self.table[self.table["status"] == "done"]
        stack = done["thickness_mm"] / done["thickness_ratio"]
        return done.assign(thickness_mm_1d=stack * done["thickness_ratio_1d"])

    def umat_history(self, material: str, temperature: float, layup: str, width: float) -> pd.DataFrame:
        """Time [s], thickness ratio [-] and thickness [mm] of a case at its increments, the law's beside; empty without it."""
        rows = self.driven
        rows = rows[(rows[KEYS] == [material, temperature, layup, width]).all(axis=1)]
        if rows.empty:
            return pd.DataFrame(columns=["time_s", "thickness_ratio", "thickness_mm", "thickness_ratio_1d", "thickness_mm_1d"])
        row = rows.iloc[0]
        time, ratio = (np.array(row[name].split(), dtype=float) for name in ("times_s", "thickness_ratios"))
        case = Case(material, temperature, layup, width, LOAD)
        stack = case.blocks * case.block_thickness
        beside = integrate(case.law(), case.load_programme, np.minimum(time, case.load_programme.end)).thickness_ratio
        columns = {"time_s": time, "thickness_ratio": ratio, "thickness_mm": stack * ratio}
        return pd.DataFrame(columns | {"thickness_ratio_1d": beside, "thickness_mm_1d": stack * beside})

    @cached_property
    def missing(self) -> int:
        """How many of the 56 cases of section 5 are not there: the claims compare them all."""
        wanted = {tuple(getattr(case, name) for name in KEYS) for case in all_cases() if case.layup != "SB"}
        return len(wanted - set(self.driven[KEYS].itertuples(index=False, name=None)))

    def claims_table(self) -> pd.DataFrame:
        """The cases as the claims look at them; see `plyflow.paper.claims.programme_table`."""
        names = {"thickness_ratio": "thickness", "thickness_ratio_limit": "limit", "width_ratio": "widening"}
        return self.driven.rename(columns=names | {"lock_time_s": "lock_time"}).assign(locked=self.driven["locked_share"] == 1.0)


def read_laminates(path: Path, measured: Path | None = None) -> LaminateModel:
    """Cases of a sweep of laminates (its folder, result.parquet or result.csv) and measured points.

    Parameters
    ----------
    measured : Path or None
        CSV with the columns material, temperature [degC], layup, width [mm] and thickness_mm or width_ratio or both: the
        state of a specimen after the test.

    Raises
    ------
    InputError
        No such files, columns missing, values of other inputs than the programme's.
    """
    table = _read(path / "result.parquet" if path.is_dir() else path, NEEDED, "the result of plyflow sweep --model laminate")
    for name, wanted in (("load", LOAD), ("scene", "default")):
        other = sorted(set(table[name]) - {wanted})
        if other:
            raise InputError(f"{path}: {name} {other[0]}; the figures are those of {wanted}")
    twice = table[table.duplicated(KEYS)]
    if len(twice):
        raise InputError(f"{path}: {' '.join(map(str, twice[KEYS].iloc[0]))} is there twice; give each case once")
    if not (table["status"] == "done").any():
        raise InputError(f"{path}: no case was finished")
    if measured is None:
        return LaminateModel(table=table)
    points = _read(measured, KEYS, "measured points")
    if not set(MEASURED) & set(points):
        raise InputError(f"{measured}: no column {' or '.join(MEASURED)}")
    return LaminateModel(table=table, points=points.reindex(columns=[*KEYS, *MEASURED]))


def _read(path: Path, needed: Sequence[str], what: str) -> pd.DataFrame:
    try:
        table = pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_csv(path, comment="#")
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as {what}: {error}") from error
    missing = [name for name in needed if name not in table]
    if missing:
        raise InputError(f"{path}: no column {missing[0]}; {what} has {', '.join(needed)}")
    return table


def inner_spreads_more(table: pd.DataFrame) -> Finding:
    """The inner blocks of BP end wider than the outer ones, which the plates hold."""
    blocked = table[table["layup"] == "BP"]
    more = blocked["width_ratio_inner"] - blocked["width_ratio_outer"]
    words = f"inner blocks end {more.min():.4f} to {more.max():.4f} of w0 wider in {count_text(len(more), 'BP case', 'BP cases')}"
    return Finding(Verdict.HOLDS if more.min() > 0.0 else Verdict.FAILS, float(more.min()), words)


# Semi-blocked specimens are not in section 5.
CLAIMS_OF_LAMINATES: tuple[Claim, ...] = (
    *(claim for claim in CLAIMS if claim.key != "merged"),
    Claim("inner", "Inner blocks spread more than outer ones.", "section 5.1", "in every BP case", inner_spreads_more),
)
