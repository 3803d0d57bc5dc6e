"""Where the registered equations hold: states in which their premises are met, and how the emitted law goes beyond them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath as mp
import sympy as sp

from umataudit.entries import Entry
from umataudit.numbers import Matrix, invariants
from umataudit.printed.tables import TABLE_4
from umatgen.model import elastic, viscous
from umatgen.notation import sym

_SAME = mp.mpf(10) ** -12
_LOCK = mp.mpf("-0.06")
_STATES = {
    "squeezing to $h/h0 = 0.95$, $J = 1$": [[1, 0, 0], [0, 1 / mp.mpf("0.95"), 0], [0, 0, mp.mpf("0.95")]],
    "squeezing with a dilation of 0.1 %": [[1, 0, 0], [0, mp.mpf("1.001") / mp.mpf("0.95"), 0], [0, 0, mp.mpf("0.95")]],
    "bleeding to $h/h0 = 0.8$, width of the lock": [[1, 0, 0], [0, mp.exp(-_LOCK), 0], [0, 0, mp.mpf("0.8")]],
    "fibre stretch 1.001": [[mp.mpf("1.001"), 0, 0], [0, 1, 0], [0, 0, 1]],
    "dilation of 0.1 %": [[mp.mpf("1.001") if i == j else 0 for j in range(3)] for i in range(3)],
    "compressed in the ply plane, 0.95": [[1, 0, 0], [0, mp.mpf("0.95"), 0], [0, 0, 1 / mp.mpf("0.95")]],
    "axial shear 0.3": [[1, 0, mp.mpf("0.3")], [0, 1, 0], [0, 0, 1]],
    "transverse shear 0.12": [[1, 0, 0], [0, 1, mp.mpf("0.12")], [0, 0, 1]],
}
PREMISES = {
    "13": "$I1$ and $I3$ give the thickness: inextensible fibre, no shear, the smaller transverse stretch",
    "14": "$I1 - 1 - chi_l$ gives the thickness: inextensible fibre, no shear, width of the lock",
    "4a": "the width is $w0 exp(-eps)$: squeezing at constant volume",
    "4b": "the width is $w0 exp(-eps_l)$",
    "": "no premise on the state",
}
"""What an equation takes for granted of the state."""
_BY_WIDTH = {"4a": "4a", "5a": "4a", "5-chi_l": "4a", "4b": "4b", "5b": "4b"}


@dataclass(frozen=True)
class Place:
    """A state: eps of the emitted law, and of the printed invariants before and after the lock; None where that is not real.

    `norm` is the printed (I1 - 1)^2 - 2 I3 over A:A, `width` the stretch across the fibre in the ply plane.
    """

    state: str
    emitted: float
    squeeze: float | None
    bleed: float | None
    norm: float
    width: float

    @property
    def met(self) -> set[str]:
        """Keys of the premises that are met."""
        differences = {
            "13": max(abs((self.squeeze if self.squeeze is not None else 1) - self.emitted), abs(self.norm - 1)),
            "14": abs((self.bleed if self.bleed is not None else 1) - self.emitted),
            "4a": abs(mp.log(self.width) + self.emitted), "4b": abs(mp.log(self.width) + _LOCK), "": 0,
        }  # fmt: skip
        return {key for key, difference in differences.items() if difference < _SAME}


@cache
def places() -> tuple[Place, ...]:
    """Every state, with `eps_lock` = -0.06 for the invariants of bleeding."""
    return tuple(_place(name, mp.matrix(f)) for name, f in _STATES.items())


def _place(name: str, f: Matrix) -> Place:
    with mp.workdps(40):
        values = invariants(f)
        trace, area2 = values["i1"] - 1, values["det_f"] ** 2
        root = trace**2 - 4 * area2
        if abs(root) < _SAME:
            root = mp.mpf(0)
        squeeze = None if root < 0 else float(mp.log((trace - mp.sqrt(root)) / 2) / 2)
        x_bleed = trace - mp.exp(-2 * _LOCK)
        bleed = float(mp.log(x_bleed) / 2) if x_bleed > 0 else None
        norm = (trace**2 - 2 * area2) / values["a_norm2"]
        return Place(name, float(mp.log(values["stretch"])), squeeze, bleed, float(norm), float(values["width"]))


def premise_of(entry: Entry) -> str:
    """Key of the premise of a registered relation: by the invariants that its formula has, or by the width of its cell."""
    value = entry.finding.shown.reading.formula.value
    names = {s.name for s in value.free_symbols} if isinstance(value, sp.Expr) else set()
    if "I1b" in names:
        return "14"
    return "13" if {"I3", "x_end"} & names else _BY_WIDTH.get(entry.finding.relation.id, "")


def holds_in(premise: str) -> Sequence[str]:
    """The states in which a premise is met."""
    return [place.state for place in places() if premise in place.met]


@cache
def shear_share() -> sp.Expr:
    """Shear stress over eta_micro, rate factor and shear rate at F = 1 before the lock: g of the law without eta_micro."""
    micro, rate, det_f, stretch, norm = sym("micro", "rate", "det_f", "stretch", "a_norm2")
    factors = {d.symbol: d.expr for d in viscous.factors("squeeze") if d.symbol.name in {"ply", "j2_unit"}}
    g = viscous.viscous_factor().subs(factors).subs({det_f: 1, stretch: 1, norm: 2})
    return sp.simplify(g / (micro * rate))


def extensions(w0: float, h0: float, eps_lock: float, eps_end: float, held: bool) -> list[tuple[str, str, str]]:
    """What was extended, why, and a number for it; a case gives the dimensions, the lock and its last strain."""
    found = {place.state: place for place in places()}
    names = ("axial shear 0.3", "transverse shear 0.12", "compressed in the ply plane, 0.95")
    axial, across, pressed = (found[name] for name in names)
    w, h = sym("w0", "h0")
    share = float(shear_share().subs({w: w0, h: h0}))
    widening = mp.exp(4 * (eps_end + eps_lock))  # stress along an axis: 2 g C^2 d/J, with g and J common to both axes
    width = (
        "after the lock the width is held by a constraint (`after_lock = held`)" if held
        else "after the lock nothing but viscosity holds the width"
    )  # fmt: skip
    return [
        (
            "the strain is that of the thickness along the ply normal, and the norm in Eq. 13 that of the transverse block of $C$",
            "$I1$ and $I3$ are derived for an inextensible, unsheared fibre; a finite element passes other states too",
            f"by the printed invariants an axial shear of 0.3 has $eps = {axial.squeeze:.3f}$, a transverse one of 0.12 "
            f"${across.squeeze:.3f}$, both without a change of thickness; a ply that thickens by 5 % under load in its plane "
            f"${pressed.squeeze:.3f}$ in place of ${pressed.emitted:.3f}$; a dilation no real value",
        ),
        (
            "a shear rate meets the same factor as a compaction rate", "the paper has no law of shear (section 6 says so)",
            f"a shear stress is $w0^2/(2 h0^2)$ times $eta_micro$, {share:.0f} times for this case",
        ),
        (
            "the stress is an odd function of the rate", "Eq. 2 has no real value for a ply that grows thicker",
            "by choice: opening meets the resistance of closing",
        ),
        (
            width, "the paper's 'no further transverse expansion' is a state of deformation, not a force that holds it",
            "none: the width stays" if held else
            f"at the end of this case a tension on the edges equal to the pressure widens the ply {float(widening):.2g} times as "
            "fast as it thins; before the lock the constraint has it widen as fast",
        ),
        (
            "where an increment passes the lock the rate in the ply plane counts from the width at the lock, and $J2$ leaves it out",
            "so that no increment has to end on the lock: with a free edge that rate vanishes and the stress is that of Eq. 14",
            "see the question about it above",
        ),
    ]  # fmt: skip


def of_table_4() -> dict[sp.Symbol, sp.Expr]:
    """Constants of Eq. 10 from Table 4, exact."""
    names = zip(sym("e_l", "e_t", "nu_lt", "nu_tt", "g_lt"), ("E1", "E2", "nu12", "nu23", "G13"), strict=True)
    numbers: dict[sp.Symbol, sp.Expr] = {symbol: sp.Rational(TABLE_4[name]) for symbol, name in names}
    for symbol, expr in elastic.moduli().items():
        numbers[symbol] = expr.subs(numbers)
    return numbers


def elastic_curvature() -> Callable[[Any, Any, Any], Any]:
    """d2W/dt2 of W(F + t m N) at a fibre stretch, for unit m, N at angles p, q to the fibre: the elastic part with Table 4."""
    stretch, p, q, t = sp.symbols("stretch p q t", real=True)
    f = sp.diag(stretch, 1, 1) + t * sp.Matrix([sp.cos(p), sp.sin(p), 0]) * sp.Matrix([[sp.cos(q), sp.sin(q), 0]])
    c = f.T * f
    i1, i4, i5, det_f = sym("i1", "i4", "i5", "det_f")
    w = elastic.potential().subs(of_table_4()).subs({i1: c.trace(), i4: c[0, 0], i5: (c * c)[0, 0], det_f: f.det()})
    function: Callable[[Any, Any, Any], Any] = sp.lambdify([stretch, p, q], w.diff(t, 2).subs(t, 0), "numpy", cse=True)
    return function
