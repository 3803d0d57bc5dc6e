"""What the driver hands back, read out of the Fortran binding."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas as pd

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

# The numbers of driver_kinds.f90 for how an attempt ended.
OUTCOMES = (
    "converged",
    "max_iterations",
    "diverged",
    "not_finite",
    "inverted",
    "singular",
    "pnewdt",
    "accuracy",
    "stopped",
    "converged_to_rounding",
)
_CONVERGED = (0, 9)
# Columns of a state row before the state variables, as in driver_history.f90.
_FIXED_COLUMNS = 33


@dataclass(frozen=True)
class FailedIncrement:
    """The increment that ended an analysis: enough to call the UMAT again exactly so.

    Deformation gradients (3, 3), stress and strain at its start (6,), state variables and energies at its
    start, times in s, the outcome as in `OUTCOMES`.
    """

    deformation_gradient_start: FloatArray
    deformation_gradient_end: FloatArray
    stress: FloatArray
    strain: FloatArray
    statev: FloatArray
    energies: FloatArray
    step_time: float
    total_time: float
    increment_size: float
    step: int
    increment: int
    outcome: str
    props: FloatArray
    temperature: float
    temperature_increment: float
    material_name: str


@dataclass(frozen=True)
class TangentCheck:
    """Where DDSDDE differed most from central differences of the Kirchhoff stress.

    `difference` is relative to the largest entry of the numerical tangent, (6, 6) in MPa; `row` is the row of
    the history, `entry` the Voigt indices from 0.
    """

    difference: float
    row: int
    entry: tuple[int, int]
    ddsdde: FloatArray
    numerical: FloatArray


@dataclass(frozen=True)
class History:
    """What happened; row 0 of the arrays is the start, row i the end of the i-th accepted increment.

    Attributes
    ----------
    time, step_time, increment
        (n,) in s: total time, time since the step's start, size of the increment.
    step, increment_number, iterations
        (n,) counted from 1; iterations are linear solutions, 1 where none was needed.
    deformation_gradient, stress, pressure
        (n, 3, 3); Cauchy stress (n, 6) in MPa in Abaqus's order, the multiplier's pressure included; that
        pressure (n,) in MPa, positive in tension.
    strain, statev, energies
        (n, 6) STRAN; (n, n_statev); (n, 3) SSE, SPD, SCD in MPa.
    work, work_right
        (n,) external work per reference volume in MPa: trapezoidal sum of P:dF, and the sum with P at the
        right end of each increment.
    residuals
        For each row the residuals of its iterations relative to the load scale.
    attempts
        (8, attempts) the columns of `increment_table`, the last as the number of its outcome.
    completed, message, warnings
        Whether the programme was finished; if not why; what the UMAT said on the way.
    cutbacks_by_reason
        Failed attempts by the names in `OUTCOMES`.
    run_time_s
        Processor time of the run, in s.
    """

    time: FloatArray
    step_time: FloatArray
    increment: FloatArray
    step: IntArray
    increment_number: IntArray
    iterations: IntArray
    deformation_gradient: FloatArray
    stress: FloatArray
    pressure: FloatArray
    strain: FloatArray
    statev: FloatArray
    energies: FloatArray
    work: FloatArray
    work_right: FloatArray
    residuals: tuple[FloatArray, ...]
    attempts: FloatArray
    completed: bool
    message: str
    warnings: str
    cutbacks_by_reason: dict[str, int]
    umat_calls: int
    tangent_check: TangentCheck | None
    failure: FailedIncrement | None
    run_time_s: float

    @property
    def increments(self) -> int:
        """Accepted increments."""
        return len(self.time) - 1

    @property
    def total_iterations(self) -> int:
        """Iterations of all attempts."""
        return int(self.attempts[3].sum())

    @property
    def cutbacks(self) -> int:
        """Failed attempts, those ended through PNEWDT included."""
        return sum(self.cutbacks_by_reason.values())

    @property
    def rounding_accepts(self) -> int:
        """Increments accepted at the rounding of F above the residual tolerance."""
        return int((self.attempts[7] == OUTCOMES.index("converged_to_rounding")).sum())

    @cached_property
    def increment_table(self) -> pd.DataFrame:
        """As Abaqus's .sta: step, increment, attempt, iterations, total_time, step_time, increment_size, note; a row an attempt."""
        import pandas as pd  # noqa: PLC0415 - a third of a second that a run without the table need not spend

        names = ("step", "increment", "attempt", "iterations", "total_time", "step_time", "increment_size")
        columns = {name: row.astype(int) if n < 4 else row for n, (name, row) in enumerate(zip(names, self.attempts, strict=False))}
        return pd.DataFrame({**columns, "note": [OUTCOMES[int(outcome)] for outcome in self.attempts[7]]})


def collect(binding: Any, completed: bool, run_time: float) -> History:
    """Everything the last run of the binding left behind."""
    n_columns, n_states, n_attempt_columns, n_attempts, n_residuals, n_props, umat_calls = binding.get_sizes()
    # One row at least: none at all does not pass.
    rows = np.zeros((n_columns, max(1, n_states)), order="F")
    attempts = np.zeros((n_attempt_columns, max(1, n_attempts)), order="F")
    residuals = np.zeros((2, max(1, n_residuals)), order="F")
    binding.get_tables(*rows.shape, rows, *attempts.shape, attempts, residuals.shape[1], residuals)
    rows, attempts, residuals = rows.T[:n_states], attempts[:, :n_attempts], residuals[:, :n_residuals]
    message, warnings = (text_of(text) for text in binding.get_message())
    return History(
        time=rows[:, 0],
        step_time=rows[:, 1],
        increment=rows[:, 4],
        step=rows[:, 2].astype(np.int64),
        increment_number=rows[:, 3].astype(np.int64),
        iterations=rows[:, 5].astype(np.int64),
        deformation_gradient=rows[:, 6:15].reshape(-1, 3, 3),
        stress=rows[:, 15:21],
        pressure=rows[:, 21],
        strain=rows[:, 22:28],
        energies=rows[:, 28:31],
        work=rows[:, 31],
        work_right=rows[:, 32],
        statev=rows[:, _FIXED_COLUMNS:],
        residuals=_residuals_by_row(residuals, n_states),
        attempts=attempts,
        completed=completed,
        message=message,
        warnings=warnings,
        cutbacks_by_reason=_cutbacks(attempts),
        umat_calls=int(umat_calls),
        tangent_check=_tangent_check(binding),
        failure=None if completed else _failure(binding, n_columns - _FIXED_COLUMNS, n_props),
        run_time_s=run_time,
    )


def _cutbacks(attempts: FloatArray) -> dict[str, int]:
    outcomes = attempts[7].astype(int)
    failed = outcomes[~np.isin(outcomes, _CONVERGED)]
    return {OUTCOMES[outcome]: int((failed == outcome).sum()) for outcome in np.unique(failed)}


def text_of(raw: bytes | str) -> str:
    """A Fortran string without its padding."""
    return (raw.decode("utf-8", "replace") if isinstance(raw, bytes) else raw).strip()


def _residuals_by_row(residuals: FloatArray, n_states: int) -> tuple[FloatArray, ...]:
    ends = np.searchsorted(residuals[0], np.arange(1, n_states + 1), side="right")
    return tuple(np.split(residuals[1], ends))[:n_states]


def _tangent_check(binding: Any) -> TangentCheck | None:
    worst, ddsdde, numerical = np.zeros(4), np.zeros((6, 6), order="F"), np.zeros((6, 6), order="F")
    binding.get_tangents(worst, ddsdde, numerical)
    if worst[1] == 0:
        return None
    entry = (int(worst[2]) - 1, int(worst[3]) - 1)
    return TangentCheck(float(worst[0]), int(worst[1]) - 1, entry, ddsdde, numerical)


def _failure(binding: Any, n_statev: int, n_props: int) -> FailedIncrement | None:
    """The failing increment; `None` if the analysis ended between two increments."""
    start, end = np.zeros((3, 3), order="F"), np.zeros((3, 3), order="F")
    stress, strain, statev, props = np.zeros(6), np.zeros(6), np.zeros(n_statev), np.zeros(n_props)
    energies, times, numbers = np.zeros(3), np.zeros(3), np.zeros(3, dtype=np.int32)
    name, temperature, heating = binding.get_failure(
        start, end, stress, strain, n_statev, statev, n_props, props, energies, times, numbers
    )
    if times[2] == 0.0:
        return None
    return FailedIncrement(
        deformation_gradient_start=start,
        deformation_gradient_end=end,
        stress=stress,
        strain=strain,
        statev=statev,
        energies=energies,
        step_time=float(times[0]),
        total_time=float(times[1]),
        increment_size=float(times[2]),
        step=int(numbers[0]),
        increment=int(numbers[1]),
        outcome=OUTCOMES[int(numbers[2])],
        props=props,
        temperature=float(temperature),
        temperature_increment=float(heating),
        material_name=text_of(name),
    )
