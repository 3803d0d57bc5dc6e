"""Piecewise cubics over temperature: the monotone cubic of Fritsch and Carlson as plain numbers.

Plain numbers, because generated Fortran holds the same table: both evaluate
((c3 s + c2) s + c1) s + c0 with s = temperature - breakpoint, in this order, and agree to rounding.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.interpolate import PchipInterpolator

Cubic = tuple[float, float, float, float]


@dataclass(frozen=True)
class CubicPieces:
    """A parameter over temperature, one cubic between each two breakpoints.

    Attributes
    ----------
    breakpoints : (n,)
        Temperatures [degC], increasing. A parameter known at one temperature only has it twice.
    coefficients : (n - 1, 4)
        c3, c2, c1, c0 of each piece: ((c3 s + c2) s + c1) s + c0, s [degC] counted from the piece's first breakpoint.
    end_slopes : (2,)
        Slopes [1/degC] at the first and the last breakpoint, with which a linear extrapolation goes on.
    """

    breakpoints: tuple[float, ...]
    coefficients: tuple[Cubic, ...]
    end_slopes: tuple[float, float]

    def at(self, temperature: float) -> float:
        """Value at a temperature [degC]; outside the breakpoints straight on with the slope at the end."""
        low, high = self.breakpoints[0], self.breakpoints[-1]
        inside = min(max(temperature, low), high)
        piece = min(bisect_right(self.breakpoints, inside), len(self.coefficients)) - 1
        c3, c2, c1, c0 = self.coefficients[piece]
        s = inside - self.breakpoints[piece]
        value = ((c3 * s + c2) * s + c1) * s + c0
        if temperature == inside:
            return value
        return value + self.end_slopes[0 if temperature < low else 1] * (temperature - inside)


def monotone_cubic(temperatures: Sequence[float], values: Sequence[float]) -> CubicPieces:
    """The monotone cubic (PCHIP) through values (n,) at temperatures (n,) [degC]; one value is a constant."""
    if len(values) == 1:
        return CubicPieces((temperatures[0], temperatures[0]), ((0.0, 0.0, 0.0, values[0]),), (0.0, 0.0))
    cubic = PchipInterpolator(temperatures, values)
    c3, c2, c1, c0 = cubic.c.tolist()
    slope = cubic.derivative()
    return CubicPieces(
        tuple(cubic.x.tolist()),
        tuple(zip(c3, c2, c1, c0, strict=True)),
        (float(slope(temperatures[0])), float(slope(temperatures[-1]))),
    )
