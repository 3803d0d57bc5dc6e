"""Where the registered equations hold: states in which the paper's invariants are those of the emitted law, and where not."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
_STATES = {
    "squeezing to h/h0 = 0.95, J = 1": [[1, 0, 0], [0, 1 / mp.mpf("0.95"), 0], [0, 0, mp.mpf("0.95")]],
    "squeezing with a dilation of 0.1 %": [[1, 0, 0], [0, mp.mpf("1.001") / mp.mpf("0.95"), 0], [0, 0, mp.mpf("0.95")]],
    "bleeding to h/h0 = 0.8, width of the lock": [[1, 0, 0], [0, mp.exp(mp.mpf("0.06")), 0], [0, 0, mp.mpf("0.8")]],
    "fibre stretch 1.001": [[mp.mpf("1.001"), 0, 0], [0, 1, 0], [0, 0, 1]],
    "dilation of 0.1 %": [[mp.mpf("1.001") if i == j else 0 for j in range(3)] for i in range(3)],
    "compressed in the ply plane, 0.95": [[1, 0, 0], [0, mp.mpf("0.95"), 0], [0, 0, 1 / mp.mpf("0.95")]],
    "axial shear 0.3": [[1, 0, mp.mpf("0.3")], [0, 1, 0], [0, 0, 1]],
    "transverse shear 0.12": [[1, 0, 0], [0, 1, mp.mpf("0.12")], [0, 0, 1]],
}
_LOCK = mp.mpf("-0.06")
_SQUEEZE, _BLEED = {"I1", "I1s", "I3"}, {"I1b"}


@dataclass(frozen=True)
class Place:
    """A state: eps of the emitted law, and of the printed invariants before and after the lock; None where that is not real."""

    state: str
    emitted: float
    squeeze: float | None
    bleed: float | None
    norm: float

    @property
    def agrees(self) -> dict[str, bool]:
        """By stage, whether the printed invariants are those of the emitted law."""
        before = self.squeeze is not None and abs(self.squeeze - self.emitted) < 1e-12 and abs(self.norm - 1) < 1e-12
        return {"squeeze": before, "bleed": self.bleed is not None and abs(self.bleed - self.emitted) < 1e-12}


@cache
def places() -> tuple[Place, ...]:
    """The emitted and the printed compaction strain, and the printed (I1 - 1)^2 - 2 I3 over A:A, in each state."""
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
        return Place(name, float(mp.log(values["stretch"])), squeeze, bleed, float((trace**2 - 2 * area2) / values["a_norm2"]))


def holds_in(entry: Entry) -> tuple[str, Sequence[str]]:
    """Invariants that a registered relation is printed in, and the states for which it holds as printed."""
    value = entry.finding.shown.reading.formula.value
    names = {s.name for s in value.free_symbols} if isinstance(value, sp.Expr) else set()
    letters = {"x_end": "I1s", "i1": "I1"}
    used = {letters.get(name, name) for name in names}
    for stage, theirs in (("bleed", _BLEED), ("squeeze", _SQUEEZE)):
        if used & theirs:
            return ", ".join(sorted(used & theirs)), [p.state for p in places() if p.agrees[stage]]
    return "", [p.state for p in places()]


@cache
def shear_share() -> sp.Expr:
    """Shear stress over eta_micro, rate factor and shear rate at F = 1 before the lock: g of the law without eta_micro."""
    micro, rate, det_f, stretch, norm = sym("micro", "rate", "det_f", "stretch", "a_norm2")
    factors = {d.symbol: d.expr for d in viscous.factors("squeeze") if d.symbol.name in {"ply", "j2_unit"}}
    g = viscous.viscous_factor().subs(factors).subs({det_f: 1, stretch: 1, norm: 2})
    return sp.simplify(g / (micro * rate))


def elastic_curvature() -> Callable[[Any, Any, Any], Any]:
    """d2W/dt2 of W(F + t m N) at a fibre stretch, for unit m, N at angles p, q to the fibre: the elastic part with Table 4."""
    stretch, p, q, t = sp.symbols("stretch p q t", real=True)
    f = sp.diag(stretch, 1, 1) + t * sp.Matrix([sp.cos(p), sp.sin(p), 0]) * sp.Matrix([[sp.cos(q), sp.sin(q), 0]])
    c = f.T * f
    i1, i4, i5, det_f, e_l, e_t, nu_lt, nu_tt, g_lt = sym("i1", "i4", "i5", "det_f", "e_l", "e_t", "nu_lt", "nu_tt", "g_lt")
    constants = {e_l: "E1", e_t: "E2", nu_lt: "nu12", nu_tt: "nu23", g_lt: "G13"}
    moduli: Mapping[sp.Symbol, sp.Expr] = elastic.moduli()
    numbers: dict[sp.Symbol, sp.Expr] = {symbol: sp.Rational(TABLE_4[name]) for symbol, name in constants.items()}
    for symbol, expr in moduli.items():
        numbers[symbol] = expr.subs(numbers)
    w = elastic.potential().subs(numbers).subs({i1: c.trace(), i4: c[0, 0], i5: (c * c)[0, 0], det_f: f.det()})
    function: Callable[[Any, Any, Any], Any] = sp.lambdify([stretch, p, q], w.diff(t, 2).subs(t, 0), "numpy", cse=True)
    return function


BEYOND = (
    "the emitted law goes beyond the printed one: its strain is that of the thickness along the ply normal, and (I1 - 1)^2 - 2 I3 is "
    "the transverse A:A. Section 4.3 derives I1 and I3 for an inextensible, unsheared fibre alone; a finite element passes other "
    "states too, in which they are not real or take a shear for a compaction"
)
