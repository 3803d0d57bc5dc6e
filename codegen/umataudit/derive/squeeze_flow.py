"""Squeezing of a strip between parallel plates without slip: the lubrication solution behind Table 1 and Eqs. 4 and 6.

Power-law fluid, shear stress = m (shear rate)^n; strip of width w and thickness h, pressure zero at its edges; the plates
approach at the rate r = -(dh/dt)/h > 0. Newtonian for n = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import sympy as sp

from umataudit.derive.derivation import Step
from umataudit.printed.letters import sym

RATE = sp.Symbol("r", positive=True)
PREMISES = (
    "parallel plates, no slip, thin strip: the shear stress is $G z$ across the thickness, $G$ the pressure gradient",
    "power-law fluid: shear stress = $eta_micro$ times the shear rate to the $n$, Newtonian for $n = 1$",
    "incompressible: what the plates displace flows out at both edges",
)


@dataclass(frozen=True)
class StripFlow:
    """The solution.

    pressure : mean pressure; wall_shear_rate : at the plates, at the edges; local_rate : thinning rate in the mid-plane;
    steps : how it is reached.
    """

    pressure: sp.Expr
    wall_shear_rate: sp.Expr
    local_rate: sp.Expr
    steps: tuple[Step, ...]


@cache
def strip_flow(newtonian: bool = False) -> StripFlow:
    """Solve the strip, for a general exponent n or for n = 1."""
    m, n, w, h = sym("m n w h")
    if newtonian:
        n = sp.S.One
    x, z, s, gradient = sp.symbols("x z s G", positive=True)
    shear = (gradient * s / m) ** (1 / n)
    flux = sp.simplify(2 * sp.integrate(s * shear, (s, 0, h / 2)))
    solved = m * (RATE * h * x / (flux / (gradient / m) ** (1 / n))) ** n
    pressure = sp.powsimp(
        sp.simplify(sp.integrate(sp.expand_power_base(x * solved, force=True), (x, 0, w / 2)) * 2 / w)
    )
    at_wall = sp.simplify(shear.subs(s, h / 2).subs(gradient, solved).subs(x, w / 2))
    velocity = sp.integrate(shear, (s, z, h / 2)).subs(gradient, solved)
    local = sp.simplify(sp.diff(velocity, x).subs(z, 0))
    steps = (
        Step("flow through a section of half the strip, twice the integral of $z$ times the shear rate", flux),
        Step("what is displaced up to $x$, $r h x$, gives the pressure gradient", sp.simplify(solved)),
        Step("mean pressure: $2/w$ times the integral of $x G$ from 0 to $w/2$", pressure),
    )
    return StripFlow(pressure, at_wall, local, steps)


def constant_volume(expr: sp.Expr) -> sp.Expr:
    """Width and thickness at the strain eps when the material between the plates keeps its volume: w h = w0 h0."""
    w0, h0, w, h, eps = sym("w0 h0 w h eps")
    return expr.subs({w: w0 * sp.exp(-eps), h: h0 * sp.exp(eps)})


def constant_width(expr: sp.Expr) -> sp.Expr:
    """Width w0 at every thickness."""
    w0, h0, w, h, eps = sym("w0 h0 w h eps")
    return expr.subs({w: w0, h: h0 * sp.exp(eps)})
