"""The load of a case: the paper's programmes by name, or a file with force or pressure over time."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from plyflow.case.measured_file import MeasuredFile, read_measured
from plyflow.case.programme import LOADS, load_programme, paper_programme
from plyflow.case.quantities import QUANTITIES
from plyflow.errors import InputError
from plyflow.law import LoadProgramme

RESPONSE = ("thickness", "width")
NOISE_BELOW_ZERO = 0.05
LARGEST_PRESSURE, HINTS = 100.0, {"force": "mN", "pressure": "kPa"}  # MPa; a unit likely forgotten


def find_load(load: str, width: float) -> LoadProgramme:
    """Plate pressure over time from a name of `LOADS` or the path of a file; force becomes pressure by width x width [mm2].

    A file has a column of time and one of force or pressure; with one of temperature it is a cycle.

    Raises
    ------
    InputError
        Neither a known name nor a readable file; a file that does not describe a load, with the line.
    """
    if load.lower() in LOADS:
        return load_programme(load.lower(), width)
    if not Path(load).suffix and not Path(load).exists():
        raise InputError(f"unknown load '{load}': choose one of {', '.join(LOADS)}, or give a file NAME.csv")
    return read_load(Path(load), width)


def load_line(load: str, width: float) -> str:
    """Where a load comes from, for the list of assumptions."""
    if load not in LOADS:
        return f"load: straight pieces through the readings of {load}"
    programme, forces = paper_programme(), "the paper's forces"
    if width not in {specimen.width for specimen in programme.specimen}:
        forces = f"forces scaled to the baseline's pressures, the paper has no {width:g} mm specimen"
    if load == "monotonic":
        return f"load: {forces}, from 0 in {programme.total_time:g} s"
    return (
        f"load: {forces}, each level {programme.dwell_level_time:g} s including a {programme.ramp_time:g} s "
        "linear ramp from the last, the first from 0"
    )


def read_load(path: Path, width: float) -> LoadProgramme:
    """Plate pressure over time from a file; see `find_load`."""
    measured = read_measured(path, ["time"], ["force", "pressure", "temperature", *RESPONSE])
    response = [name for name in RESPONSE if name in measured.columns]
    if response:
        measured.notes.append(f"{' and '.join(response)} of {path} are what a test gave: no part of the load")
    given = [name for name in ("force", "pressure") if name in measured.columns]
    if len(given) != 1:
        raise InputError(f"{path}: needs one column 'force [N]' or 'pressure [MPa]' beside the time, found {len(given)}")
    values = pushing(measured, given[0])
    pressures = values / (width * width) if given[0] == "force" else values
    if pressures.max() > LARGEST_PRESSURE:
        raise InputError(
            f"{path}: {given[0]} up to {values.max():g} {QUANTITIES[given[0]].unit} is a pressure of {pressures.max():.4g} MPa, more "
            f"than {LARGEST_PRESSURE:g} MPa: give the unit in the heading, such as '{given[0]} [{HINTS[given[0]]}]'"
        )
    return programme_of(measured, pressures, measured.columns.get("temperature"))


def pushing(measured: MeasuredFile, name: str) -> np.ndarray:
    """Readings (n,) of force or pressure, those a little below 0 (the sensor's zero and noise) taken as 0.

    Raises
    ------
    InputError
        A reading is below 0 by more than a twentieth of the largest: the law describes compaction only.
    """
    values, unit = measured.columns[name], QUANTITIES[name].unit
    bound = 0.0 - NOISE_BELOW_ZERO * max(float(values.max()), 0.0)
    pulling = np.flatnonzero(values < bound)
    if pulling.size:
        row = int(pulling[0])
        raise measured.error(
            row,
            f"{name} {values[row]:g} {unit} is below {bound:g} {unit}, a twentieth of the largest: the law describes "
            "compaction; is the sign reversed? Leave pulling out",
        )
    return np.maximum(values, 0.0)


def programme_of(measured: MeasuredFile, pressures: np.ndarray, temperatures: np.ndarray | None = None) -> LoadProgramme:
    """Readings of pressure [MPa] as a load programme; a test that starts after 0 s is loaded linearly from 0.

    With temperatures [degC] it is a cycle.
    """
    times = measured.columns["time"]
    if times[0] < 0.0:
        raise measured.error(0, f"time {times[0]:g} s is below 0: count from the start of the test")
    start = [] if times[0] == 0.0 else [0.0]
    heat = [] if temperatures is None else temperatures.tolist()
    pressure = (*start, *pressures.tolist())
    return LoadProgramme((*start, *times.tolist()), pressure, tuple(measured.notes), (*heat[: len(start)], *heat))
