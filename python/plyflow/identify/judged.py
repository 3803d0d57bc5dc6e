"""What a fit does not know: parameters that the readings leave open, and readings that the law does not follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import PlyflowError
from plyflow.identify.force import noise_of
from plyflow.identify.model import NAMES, residuals
from plyflow.identify.refine import Fit, fit
from plyflow.identify.specimen import SMALLEST_K, Specimen
from plyflow.identify.valley import TIED

FloatArray = NDArray[np.float64]
LARGEST_REACH = {"k": 0.25, "a": 0.25, "b_squeeze": 3.0, "b_bleed": 3.0}  # half an interval; exp(3) is a factor of 20 in viscosity
UNIT_STEP = {"k": 0.01, "a": 0.01, "b_bleed": 0.1}  # what counts as much in one parameter as in another, for the valley
# The scatter may be so many times the noise of the readings, or this share of the thickness; tests made from the law with noise
# of thickness and force stay below both.
LARGEST_RATIO, LEAST_SCATTER = 1.5, 5e-4
# Residuals in so many stretches of readings: mean square of the stretches' means over what the noise gives them.
# Tests made from the law have up to 1.7 (56 fits), one whose thickness drifts by 48 um in 1200 s has 11.
STRETCHES, LARGEST_COURSE = 12, 3.0
AT_START = 5.0  # standard deviations of the readings before the load began
LEAST_NOISE = 1e-5  # of the thickness: below, the law as computed and smoothed is no better


@dataclass(frozen=True)
class Verdict:
    """open: why a parameter is not determined, by name; valley: in which direction, in words; misfit: what is wrong in words."""

    open: dict[str, str]
    valley: str
    misfit: tuple[str, ...]

    @property
    def sound(self) -> bool:
        """Whether all parameters are determined and the law follows the readings."""
        return not self.open and not self.misfit


def judge(found: Fit) -> Verdict:
    """What a fit does not know, and where the law does not follow the readings."""
    undetermined = {name: reason for name in NAMES if (reason := _open(found, name))}
    if undetermined:  # along the valley the others move with it, and their intervals, taken as if it were straight, are none
        lead = next(iter(undetermined))
        undetermined |= {name: f"it is tied to {lead}" for name in NAMES if name not in undetermined}
    return Verdict(undetermined, _valley(found) if undetermined else "", tuple(_misfits(found)))


def _open(found: Fit, name: str) -> str:
    """Why the readings do not fix a parameter; empty where they do."""
    one, reach = found.estimates[name], LARGEST_REACH[name]
    largest = min(specimen.largest_k for specimen in found.specimens)
    low, high = {"k": (SMALLEST_K, largest), "a": (-1.0, 0.0)}.get(name, (-math.inf, math.inf))
    if not (math.isfinite(one.low) and math.isfinite(one.high)):
        return "its interval has no end"
    if one.low <= low or one.high >= high:
        return f"its interval, {one.low:.3g} to {one.high:.3g}, leaves {low:.4g} to {high:.4g}, where the law is one"
    if 0.5 * (one.high - one.low) > reach:
        return f"its interval, {one.low:.3g} to {one.high:.3g}, is wider than {2.0 * reach:g}"
    return ""


def _valley(found: Fit) -> str:
    """The combination of k, a and b_bleed that the readings fix least, in words."""
    units = np.array([UNIT_STEP[name] for name in TIED])
    direction = np.linalg.eigh(found.covariance / np.outer(units, units))[1][:, -1] * units
    lead = int(np.argmax(np.abs(direction / units)))
    moves = direction / direction[lead] * units[lead]
    words = [f"{name} {'+' if move >= 0.0 else '-'}{abs(move):.3g}" for name, move in zip(TIED, moves, strict=True)]
    return f"the readings fix least: {', '.join(words)} together change the curves by hardly more than the noise"


def _misfits(found: Fit) -> list[str]:
    """What the residuals say against the fit."""
    complaints = [words for specimen in found.specimens if not found.offsets and (words := _start_off(specimen))]
    for specimen in found.specimens:
        left = residuals([specimen], found.values[None])[0]
        scatter, noise = float(np.sqrt(np.mean(left**2))), noise_of(specimen.thickness)
        if scatter > max(LARGEST_RATIO * noise, LEAST_SCATTER * specimen.geometry.stack):
            complaints.append(
                f"{specimen.name}: the readings scatter by {1e3 * scatter:.3g} um about the curve and have {1e3 * noise:.2g} um of "
                "noise: the law does not follow them"
            )
        elif noise > LEAST_NOISE * specimen.geometry.stack and (course := _course(left, noise)) > LARGEST_COURSE:
            complaints.append(
                f"{specimen.name}: the readings wander about the curve {math.sqrt(course):.2g} times as far as their noise of "
                f"{1e3 * noise:.2g} um would: the law does not follow them"
            )
    return complaints


def _course(left: FloatArray, noise: float) -> float:
    """Mean square of the means of stretches of residuals over what independent noise would give."""
    parts = np.array_split(left, STRETCHES)
    return float(np.mean([part.size * part.mean() ** 2 for part in parts])) / noise**2


def _start_off(specimen: Specimen) -> str:
    """Complain about a thickness before the load began that is not that of the plies."""
    before = specimen.thickness[np.cumsum(np.maximum(specimen.pressure, 0.0)) <= 0.02 * specimen.load.peak]
    if not before.size:
        return ""
    off, error = float(before.mean()) - specimen.geometry.stack, noise_of(specimen.thickness) / math.sqrt(before.size)
    if abs(off) <= max(AT_START * error, 3.0 * LEAST_SCATTER * specimen.geometry.stack):
        return ""
    return (
        f"{specimen.name}: before the load it is {before.mean():.5g} mm thick, {1e3 * off:+.3g} um off {specimen.geometry.plies:g} "
        f"plies of {specimen.geometry.ply_thickness:g} mm: fit a zero error of the sensor with --offset, or correct --ply-thickness"
    )


def offset_hint(found: Fit, specimens: Sequence[Specimen], tie: str) -> str:
    """Whether offsets of the thickness would explain a misfit; empty if not."""
    if found.offsets:
        return ""
    try:
        other = fit(specimens, tie, offset=True)
    except PlyflowError:
        return ""
    if judge(other).misfit:
        return ""
    words = ", ".join(f"{1e3 * one.value:+.3g} um" for one in other.offsets)
    return f"an offset of the thickness ({words}) would explain it: {1e3 * other.scatter:.3g} um of scatter are left; try --offset"
