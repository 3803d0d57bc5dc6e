"""Running one case and what comes out: the UMAT driven under the load, beside the one-dimensional law."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import gettempdir
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import (
    Case,
    assumption_lines,
    driver_steps,
    property_values,
    props_vector,
    state_place,
)
from plyflow.case.solution import left_to_limit, solve
from plyflow.driver.drive import Controls, History, drive
from plyflow.errors import InputError, OutputError, RunError
from plyflow.files import json_text, write_files
from plyflow.law import LawHistory
from plyflow.law.load import LoadProgramme
from plyflow.run.accuracy import Reached, reach
from plyflow.run.lock_time import case_lock_time
from plyflow.umat.prepare import Umat

if TYPE_CHECKING:
    import pandas as pd

# Increments at refinement 1 by integrator. The creep-exact one is exact under constant load whatever the increments, so only
# the largest one matters, where the load changes; the backward difference must follow the creep's decay.
FAMILIES = {
    "creep": Controls(initial_increment=0.1, maximum_increment=30.0, growth=4.0, easy_in_a_row=1, easy_iterations=8),
    "bdf1": Controls(initial_increment=1e-2, maximum_increment=20.0, growth=1.5),
}
SMALLEST_REFINEMENT = 0.1
# For a wanted accuracy: the order of the error, and the refinement of the first run, as coarse as still goes well.
ORDERS, COARSEST = {"creep": 2, "bdf1": 1}, {"creep": 0.125, "bdf1": 0.5}
ADVICE = {
    "lower minimum_increment, or look at the loading": "look at the loading and the constants",
    "allow more, or start with smaller increments": "shorten the increments (--refine 10)",
}


@dataclass(frozen=True)
class RunResult:
    """One finished case.

    values: every PROPS by name; history: the driver's; law: the one-dimensional law at the driver's times;
    locked: whether the ply has locked, by the UMAT, at the same times; reached: what a wanted accuracy took, if one was.
    """

    case: Case
    values: Mapping[str, float]
    history: History
    law: LawHistory
    assumptions: list[str]
    provenance: dict[str, Any]
    locked: NDArray[np.bool_]
    reached: Reached[RunResult] | None = None

    @property
    def thickness_ratio(self) -> NDArray[np.float64]:
        """h/h0 (n,) from the UMAT: the stretch F33."""
        return np.asarray(self.history.deformation_gradient[:, 2, 2], dtype=float)

    @property
    def width_ratio(self) -> NDArray[np.float64]:
        """w/w0 (n,) from the UMAT: the stretch F22."""
        return np.asarray(self.history.deformation_gradient[:, 1, 1], dtype=float)

    @property
    def lock_time(self) -> float | None:
        """Time [s] at which the UMAT locked, inside the increment in which it did (`lock_time`); None if it did not."""
        return case_lock_time(self.case.of_law, self.values, self.case.load_programme, self.history, self.locked)

    @property
    def fibre_fraction(self) -> NDArray[np.float64]:
        """Fibre volume fraction (n,) [-] from the UMAT: the initial one over J."""
        return np.asarray(self.case.fibre_fraction / np.linalg.det(self.history.deformation_gradient), dtype=float)

    @property
    def time_left(self) -> float:
        """Time [s] from the end of the load to within 1 % of the limit thickness, by the law; see `plyflow.law.time_left`."""
        load = self.case.load_programme
        end = replace(self.law, **{name: getattr(self.law, name)[-1:] for name in ("time", "pressure", "eps", "locked")})
        return float(left_to_limit(self.case.of_law, load, end)[0])

    def summary(self) -> dict[str, Any]:
        """Plain data of the result, ready for JSON: ratios [-], times [s], counts."""
        case, history, law, reached = self.case, self.history, self.law, self.reached
        return {
            "material": case.material,
            "temperature": case.temperature,
            "temperature_range": case.temperature_range,
            "layup": case.layup,
            "width": case.width,
            "load": case.load,
            "thickness_ratio_final": float(self.thickness_ratio[-1]),
            "width_ratio_final": float(self.width_ratio[-1]),
            "thickness_final_mm": case.blocks * self.values["h0"] * float(self.thickness_ratio[-1]),
            "fibre_fraction_final": float(self.fibre_fraction[-1]),
            "time_left_s": self.time_left if math.isfinite(self.time_left) else None,
            "thickness_ratio_1d": float(law.thickness_ratio[-1]),
            "width_ratio_1d": float(law.width_ratio[-1]),
            "lock_time": self.lock_time,
            "lock_time_1d": law.lock_time,
            "increments": int(history.increments),
            "iterations": int(history.total_iterations),
            "cutbacks": int(history.cutbacks),
            "cutbacks_by_reason": {why: int(count) for why, count in history.cutbacks_by_reason.items()},
            "run_time_s": float(history.run_time_s),
            "accuracy": reached and reached.wanted,
            "error_estimate": reached and reached.estimate,
            "error_1d": float(self.thickness_ratio[-1] - law.thickness_ratio[-1]),
            "refinement": reached and reached.refinement,
            "increments_in_all": reached.increments if reached else int(history.increments),
            "umat_calls": int(history.umat_calls),
            "umat_calls_in_all": reached.umat_calls if reached else int(history.umat_calls),
            "assumptions": self.assumptions,
            "provenance": self.provenance,
        }

    def to_json(self) -> str:
        """`summary` as one JSON object."""
        return json_text(self.summary())

    def history_table(self) -> pd.DataFrame:
        """Time [s], pressure [MPa], thickness and width ratios [-] of UMAT and law, a row an increment."""
        import pandas as pd  # noqa: PLC0415 - see `History.increment_table`

        load = self.case.load_programme
        heat = {"temperature_degC": load.temperature(self.history.time)} if load.temperatures else {}
        return pd.DataFrame(
            {
                "time_s": self.history.time,
                **heat,
                "pressure_MPa": self.law.pressure,
                "fibre_fraction": self.fibre_fraction,
                "thickness_ratio": self.thickness_ratio,
                "width_ratio": self.width_ratio,
                "thickness_ratio_1d": self.law.thickness_ratio,
                "width_ratio_1d": self.law.width_ratio,
            }
        )


def case_controls(refinement: float = 1.0, integrator: str = "bdf1") -> Controls:
    """Increments for the compaction programme, all shorter by the factor `refinement`.

    Increments grow geometrically from the start of each step up to a largest one. At refinement 1 every case of the programme
    ends, with the integrator "creep", within 5e-5 of the one-dimensional law's thickness, and the error falls as
    1/refinement^2; with "bdf1" within 1e-3, and it falls as 1/refinement. What is good for "bdf1" is good for both.

    Raises
    ------
    InputError
        The refinement is not a finite number of at least 0.1.
    """
    if not (math.isfinite(refinement) and refinement >= SMALLEST_REFINEMENT):
        raise InputError(f"refinement {refinement:g} must be a finite number of at least {SMALLEST_REFINEMENT}")
    family = FAMILIES[integrator]
    assert family.initial_increment and family.maximum_increment
    return replace(
        family,
        initial_increment=family.initial_increment / refinement,
        maximum_increment=family.maximum_increment / refinement,
        growth=family.growth ** (1.0 / refinement),
    )


def run_case(
    case: Case,
    umat: Umat,
    controls: Controls | None = None,
    replay: Path | None = None,
    accuracy: float | None = None,
) -> RunResult:
    """Drive the UMAT through a case and integrate the one-dimensional law at the same times.

    Without `controls` the increments are those of `case_controls` for the scene's integrator. With `accuracy`, a wanted error
    of the final thickness ratio, they are made shorter until it is reached (`plyflow.run.accuracy.reach`). Where an increment
    fails, `replay` is the file that repeats it (`plyflow.run.replay`); without it none is written.

    Raises
    ------
    InputError
        The case cannot be set up: unknown material or setting, temperature or value outside its bounds; or controls and an
        accuracy are both given.
    RunError
        The driver could not finish, or not with this accuracy.
    """
    integrator = umat.manifest["scene"]["integrator"]
    if accuracy is None:
        return _run(case, umat, controls if controls is not None else case_controls(1.0, integrator), replay)
    if controls is not None:
        raise InputError("controls and accuracy exclude each other: with an accuracy the increments are picked for it")
    reached = reach(
        accuracy,
        ORDERS[integrator],
        _coarsest(case.load_programme, integrator),
        lambda refinement: _run(case, umat, case_controls(refinement, integrator), replay),
        lambda one: (float(one.thickness_ratio[-1]), one.history.increments, one.history.umat_calls),
    )
    return replace(reached.result, reached=reached)


def _coarsest(load: LoadProgramme, integrator: str) -> float:
    """Refinement to begin with: no piece of the load in one increment, else two runs agree because neither resolves it."""
    shortest = min(end - begin for begin, end, _, _ in load.pieces())
    initial = FAMILIES[integrator].initial_increment or 0.0
    return max(COARSEST[integrator], min(1.0, 1.001 * initial / shortest))


def _run(case: Case, umat: Umat, controls: Controls, replay: Path | None) -> RunResult:
    values = property_values(case, umat.manifest, follows=True)
    own = umat.manifest["scene"]["fibre_fraction"]
    if own != case.fibre_fraction:
        raise InputError(
            f"scene '{umat.manifest['name']}' has fibre_fraction = {own:g}, the case has fibre_fraction_initial = "
            f"{case.fibre_fraction:g}: prepare the UMAT with the case's"
        )
    load = case.load_programme
    if case.is_cycle:
        _check_standstill(case)
    failed = Path(gettempdir()) / f"plyflow-{uuid4().hex}.txt"  # made by the driver only if an increment fails
    history = drive(
        umat.library,
        np.array(props_vector(values, umat.manifest)),
        len(umat.manifest["statev"]),
        driver_steps(load),
        controls,
        temperature=case.temperature,
        replay=failed if replay is not None else None,
    )
    end = load.end
    if not history.completed:
        stopped = f"{case.label}: stopped at {history.time[-1]:g} s of {end:g} s: {_advised(history.message)}"
        raise RunError(stopped + _kept(failed, replay, umat))
    return RunResult(
        case=case,
        values=values,
        history=history,
        law=solve([case.of_law], load, np.minimum(history.time, end)).row(0),
        assumptions=assumption_lines(case, values),
        provenance=umat.provenance.as_dict() | {"inputs": dict(values)},
        locked=history.statev[:, state_place(umat.manifest, "locked")] >= 0.5,
    )


def _check_standstill(case: Case) -> None:
    """Refuse a cycle that cools so far that the limit passes the ply: no UMAT has a stress there."""
    still = solve([case.of_law], case.load_programme).row(0).still_time
    if still is not None:
        raise InputError(
            f"{case.label}: from {still:.5g} s on cooling has brought the compaction limit past the ply, and the UMAT has no "
            "stress there: end the file before, or use law1d, where the ply stands still from then on"
        )


def _advised(message: str) -> str:
    """What the driver says, with advice that a run has an option for in place of controls of the driver."""
    for controls, here in ADVICE.items():
        message = message.replace(controls, here)
    return message


def _kept(failed: Path, replay: Path | None, umat: Umat) -> str:
    """Keep the increment that failed and the UMAT's source, and say how to repeat it; a folder that cannot be written is said."""
    if replay is None or not failed.is_file():
        return ""
    try:
        source = replay.with_suffix(".for" if umat.manifest["scene"]["form"] == "fixed" else ".f90").name
        write_files(replay.parent, {replay.name: failed.read_text(encoding="utf-8"), source: umat.source})
    except OutputError as error:
        return f"; the increment is not kept: {error}"
    finally:
        failed.unlink()
    return f"; the increment is kept, see it again with: plyflow replay {replay}"
