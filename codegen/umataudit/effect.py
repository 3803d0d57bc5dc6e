"""What a printed form would do if it were used: its resistance to compaction over that of the derived form, and numbers.

Symbolic only; `plyflow.audit` puts the numbers of a case in and computes stress ratio and final thickness.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import sympy as sp

from umataudit.printed.formula import Value
from umataudit.printed.letters import sym
from umataudit.printed.tables import COLUMNS
from umataudit.verdict import Finding, Verdict

SQUEEZE, BLEED = "squeeze", "bleed"


@dataclass(frozen=True)
class Variant:
    """One way to use the printed form.

    Parameters
    ----------
    label : which printed part is used.
    factors : printed over derived resistance (stress at the same strain and rate) of a flow stage, in the paper's letters.
    limit : exp(eps) at which the printed form is singular, when that differs.
    lock : strain at locking, when that differs.
    settings : case parameters that differ, by name ("chi_ratio", "end_time").
    swapped : whether the two stages change places.
    """

    label: str
    factors: dict[str, sp.Expr] = field(default_factory=dict)
    limit: sp.Expr | None = None
    lock: sp.Expr | None = None
    settings: dict[str, sp.Expr] = field(default_factory=dict)
    swapped: bool = False


@dataclass(frozen=True)
class Effect:
    """Consequence of a printed form.

    Parameters
    ----------
    variants : uses whose stress ratio and final thickness are to be computed.
    numbers : (what, value) to state, in the paper's letters.
    note : what else there is to say; "no solution" and why, or why nothing changes.
    table : rows of texts, the headings first.
    """

    variants: tuple[Variant, ...] = ()
    numbers: tuple[tuple[str, sp.Expr], ...] = ()
    note: str = ""
    table: tuple[tuple[str, ...], ...] = ()


def effect(finding: Finding) -> Effect:
    """Effect of the first reading of a relation; nothing when it follows."""
    id_, first = finding.relation.id, finding.first
    if finding.verdict in {Verdict.FOLLOWS, Verdict.DEFINITION, Verdict.TAUTOLOGY}:
        return Effect(note="none: the printed form is the derived one")
    if id_ in _OF_FINDING:
        return _OF_FINDING[id_](finding)
    if id_ in _OF_FORMS:
        return _OF_FORMS[id_](first.reading.formula.value, first.derivation.result)
    if id_.startswith("ref-"):
        return Effect(note="none on a computed result: the reader is sent to the wrong place")
    if finding.verdict is Verdict.SCAN:
        return Effect(note="none: with its characters restored the form is the derived one")
    return Effect(note="none on a computed result")


def on_path(expr: sp.Expr) -> sp.Expr:
    """Invariants in pure squeezing by eps: J = 1, C11 = exp(2 eps), I1 - 1 = C11 + 1/C11, I3 = 1."""
    i1, i3, x, J, c11, lam, eps, eps_dot, cdot11, i1b = sym("I1 I3 I1s J C11 lam eps eps_dot Cdot11 I1b")
    square = sp.exp(2 * eps)
    state = {i1: 1 + square + 1 / square, i3: 1, x: square, i1b: square, J: 1, c11: square, lam: sp.exp(eps)}
    return sp.powsimp(expr.subs(cdot11, 2 * c11 * eps_dot).subs(state))


def _one(label: str, stage: str, ratio: sp.Expr, limit: sp.Expr | None = None) -> Effect:
    """Effect of one variant that changes the resistance of one stage."""
    return Effect((Variant(label, {stage: ratio}, limit),))


def _potential_squeezing(finding: Finding) -> Effect:
    printed, derived = finding.first.reading.formula.value, finding.first.derivation.result
    parts = {"all of Eq. 13 as printed": (printed, derived)}
    parts |= {f"only the {name} as printed": (part, wanted) for name, part, wanted in finding.faults}
    return Effect(tuple(Variant(label, {SQUEEZE: on_path(part / wanted)}) for label, (part, wanted) in parts.items()))


def _rate_invariant(finding: Finding) -> Effect:
    stage = SQUEEZE if finding.relation.id == "12-J2" else BLEED
    with_dot = finding.judged[1].reading.formula.value
    ratio = (finding.first.derivation.result / with_dot) ** ((sym("a")[0] + 2) / 2)
    return _one("potential built with the printed $J2$ (with its dot)", stage, on_path(ratio))


def _bleeding_i1(printed: Value, derived: Value) -> Effect:
    chi_l, i1b, k, chi_f, c11, a = sym("chi_l I1b k chi_f C11 a")
    wrong = sp.expand(printed - (1 + chi_l))
    potential = (1 / i1b) * (k / (sp.sqrt(i1b) - k / sp.sqrt(chi_f))) ** 2 * (1 / (2 * i1b**2)) ** ((a + 2) / 2)
    ratio = potential.subs(i1b, wrong) / potential.subs(i1b, c11)
    return _one("Eq. 14 with $I1b$ from the printed $I1$", BLEED, on_path(ratio), sp.sqrt(k / sp.sqrt(chi_f)))


def _elastic(*forms: Value) -> Effect:
    mu_l, lam, i4, i5, J, i1 = sym("mu_L lam_e I4 I5 J I1")
    natural, rates = {i1: 3, i4: 1, i5: 1, J: 1}, {i1: 2, i4: 2, i5: 4, J: 1}
    printed, derived = (
        sp.factor(sum(sp.diff(form, i).subs(natural) * rate for i, rate in rates.items())) for form in forms
    )
    coupling = [lam + 2 * sp.diff(form, i4, J).subs(natural) for form in forms]
    numbers = (
        ("stress along the fibre at $F = 1$ as printed [MPa]", printed),
        ("the same, derived [MPa]", derived),
        ("it over $mu_L$, as printed", printed / mu_l),
        ("stiffness 1122 as printed over derived", coupling[0] / coupling[1]),
    )
    note = (
        "thickness unchanged: in compaction the fibre is held and the moduli of Table 4 (1e-6 MPa) carry no load; "
        "a free body would not rest at $F = 1$"
    )
    return Effect(numbers=numbers, note=note)


def _tangent(*forms: Value) -> Effect:
    viscous = [form[0, 1, 0, 1].subs(sp.Symbol("Ce_1212", real=True), 0) for form in forms]
    ratio = sp.simplify(viscous[0] / viscous[1])
    numbers = (
        ("viscous tangent as printed over derived", ratio),
        ("factor of a Newton error per iteration", 1 - 1 / ratio),
    )
    note = "no solution by Newton's method where viscosity governs: an error changes sign and keeps its size"
    return Effect(numbers=numbers, note=note)


def _resin(finding: Finding) -> Effect:
    b, b_bar, eta_res = sym("b b_bar eta_res")
    label, factor = "resin viscosity in $eta_micro$ and in $exp(b)$", eta_res
    if finding.relation.id == "3.2-b":
        product = finding.first.reading.formula.value.subs(b_bar, b - sp.log(eta_res))
        label, factor = "$b$ as the product", sp.exp(product - b)
    factor = factor.subs(eta_res, sp.Rational(1, 100000))
    note = "stated state: $eta_res = 1e-5$ MPa s (10 Pa s), which the paper does not give"
    return Effect((Variant(label, {SQUEEZE: factor, BLEED: factor}),), note=note)


def _jump(printed: Value, derived: Value) -> Effect:
    X, a = sym("X a")
    drop = X**2 / (X**2 + 3)
    numbers = (
        ("stress ratio at locking, derived", drop),
        ("jump of the creep rate there", (1 / drop) ** (1 / (a + 1))),
    )
    return Effect((Variant("no drop at locking", {BLEED: 1 / drop}),), numbers)


def _indefinite(finding: Finding) -> Effect:
    steps = finding.first.derivation.steps
    minors = [sp.sympify(step.value) for step in steps if step.text.startswith("leading minor")]
    smallest = ("smallest leading minor of the compliance, one ratio [1/MPa^n]", min(minors))
    note = "no solution: with one Poisson's ratio the potential is not positive definite"
    return Effect(numbers=(smallest,), note=note)


def _frozen(printed: Value, derived: Value) -> Effect:
    """Newton's error factor with f held fixed is |dln eta/deps| |Deps|/(a + 1); it is 1 at the strain increment given."""
    eps, k, chi_f, a = sym("eps k chi_f a")
    slope = 2 + 2 * sp.sqrt(chi_f) * sp.exp(eps) / (sp.sqrt(chi_f) * sp.exp(eps) - k)  # -dln(eta_ply eta_micro)/deps, Eqs. 4b, 5b
    at = {eps: sp.log(sp.Rational("0.669"))}
    numbers = (
        ("at $h/h0 = 0.669$ Newton's error factor with $f$ held fixed, over the strain increment", (slope / (a + 1)).subs(at)),
        ("largest strain of an increment for which it is below 1", ((a + 1) / slope).subs(at)),
    )
    return Effect(numbers=numbers, note="no wrong result, but no solution by Newton's method in larger increments")


def _shear_angle(finding: Finding) -> Effect:
    """Argument, gamma_lock and the width of a blocked ply at locking by temperature, with the corrected line for alpha_f too."""
    (alpha, d, a0), half, rows, printed = sym("alpha d A0"), sp.Rational(1, 2), [], []
    for column in COLUMNS:
        ratio = sp.Rational(column.k) ** 2 / half
        angle = sp.asin(ratio * sp.sin(ratio / (1 + ratio) * sp.atan(2 * sp.Rational(column.k) ** 2 / sp.pi)))
        cell = {a0: sp.pi * d**2 / (8 * half), alpha: angle}
        gamma = sp.sympify(finding.first.derivation.result).subs(cell).subs(d, 1)
        printed.append(float(sp.N(finding.first.reading.formula.value.args[0].subs(cell).subs(d, 1))))
        rows.append((f"{column.material}, {column.temperature} C", f"none, of {printed[-1]:.2f}", f"{float(sp.deg(gamma)):.1f}",
                     f"{_width(float(sp.tan(gamma)), column.material):.3f}"))  # fmt: skip
    fixed = ", ".join(f"{_width(math.tan(math.radians(80)), name):.3f} for {name}" for name in ("IM7-8552", "IMA-M21"))
    return Effect(
        note=f"no solution as printed: the arcsine of numbers from {min(printed):.1f} to {max(printed):.1f}. Below, corrected, and "
        "the width of BP, 15 mm, that goes with it, to be held against section 2 (a rise above 50 C, level from about 70 C); a "
        f"fixed 80 degrees has {fixed} throughout",
        table=(("tape", "arcsine printed", "$gamma_lock$ [deg]", "width at the lock"), *rows),
    )  # fmt: skip


def _width(tangent: float, material: str) -> float:
    """Width over w0 at locking of a block of four plies, Eq. 6, with eps_lock = ln sqrt(4 V0/pi) of the bulk assumed."""
    ply = {"IM7-8552": 0.125, "IMA-M21": 0.165}[material]
    edge = -0.5 * math.log1p(2 / 3 * 4 * ply / 15 * tangent)
    return math.exp(-max(edge, math.log(2 / math.pi) / 3))


def _ply(finding: Finding) -> Effect:
    """The ply term as it follows literally; eta_micro is a factor of it in Table 1."""
    printed, derived = finding.first.reading.formula.value, finding.first.derivation.result
    ratio = sp.powsimp(sp.expand_power_base(derived / printed, force=True))
    return _one("what follows literally, with $b$ kept", BLEED if finding.relation.id == "4b" else SQUEEZE, ratio)


_delta, _i3, _v0 = sym("delta I3 V0")
_OF_FINDING: dict[str, Callable[[Finding], Effect]] = {
    "13": _potential_squeezing, "12-J2": _rate_invariant, "14-J2": _rate_invariant, "3.2-b": _resin, "2": _resin, "12": _resin,
    "T4.definite": _indefinite, "4a": _ply, "4-power": _ply, "4b": _ply,
    "A.1": _shear_angle,
    "17-push": lambda f: Effect(note="none if the page has $I$ and $J$; as recovered, $l$ three times, it has no value"),
}  # fmt: skip
_OF_FORMS: dict[str, Callable[[Value, Value], Effect]] = {
    "14-I1": _bleeding_i1,
    "10": _elastic,
    "16": _tangent,
    "5-lock": _jump,
    "T1.1": lambda p, d: _one("exponent of Table 1 in place of Eq. 4a", SQUEEZE, sp.powsimp(p / d)),
    "5-increase": lambda p, d: Effect(
        note="none on a computed result; taken for the stress, with the $b$ of Tables 2, 3, it drops (5-lock)"
    ),
    "T2-3.b": lambda p, d: Effect(
        note="none on a computed result: one $b$ and the constant, read as $(l0/d)^2$, give both rows"
    ),
    "4.4-rule": lambda p, d: Effect((Variant("the rule as printed: bleeding first, squeezing after", swapped=True),)),
    "16-f": _frozen,
    "5-limit": lambda p, d: Effect(numbers=(("aspect ratio where Eq. 5b is singular, over $chi_f$", d / p),)),
    "A.1-A0": lambda p, d: Effect(  # (q - 1/q)/2 with q = 4 A0/d^2 = 2 pi
        numbers=(("smallest argument of the arcsine of A.1 with a whole cell", sp.pi - 1 / (4 * sp.pi)),)
    ),
    "A.1-Vf": lambda p, d: Effect(
        numbers=(("$Vf$ as printed", p), ("$Vf$ at which Eq. 5b is singular", d.subs(_v0, sp.Rational(1, 2)))),
        note="thickness unchanged: $Vf$ enters Eq. A.1 alone",
    ),
    "A.1-trend": lambda p, d: Effect(
        numbers=(("fibre fraction at the end, from 0.5", sp.Symbol("fraction_at_end", positive=True)),)
    ),
    "T4.G23": lambda p, d: Effect(
        numbers=(("$G23$ as printed over derived", p / d),), note="thickness unchanged: no shear across the fibre in compaction"
    ),
    "4.3-stress": lambda p, d: _one(
        "$sigma_11$ alone taken for the stress of Eq. 1", SQUEEZE, on_path(sp.simplify(d / p).subs(_i3, 1))
    ),
    "5-chi_f": lambda p, d: Effect((Variant("$chi_l/chi_f = 5/7$ in place of 0.7", settings={"chi_ratio": d}),)),
    "2-duration": lambda p, d: Effect((Variant("load removed after 15 min", settings={"end_time": p}),)),
    "13-real": lambda p, d: Effect(
        numbers=(("number under the root at $delta = 0.001$", (-(_delta**2) * (3 + 4 * _delta)).subs(_delta, sp.Rational(1, 1000))),),
        note="no solution: the root is not a number for a dilation, however small",
    ),
}  # fmt: skip
