"""What a printed form would do if it were used: its resistance to compaction over that of the derived form, and numbers.

Symbolic only; `plyflow.audit` puts the numbers of a case in and computes stress ratio and final thickness.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import sympy as sp

from umataudit.printed.formula import Formula, Value
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
    relation = finding.relation
    if finding.verdict in {Verdict.FOLLOWS, Verdict.DEFINITION, Verdict.TAUTOLOGY}:
        return Effect(note="none: the printed form is the derived one")
    if relation.id in _COMPUTED:
        return _COMPUTED[relation.id](finding)
    if relation.effect:
        return stated(finding)
    if relation.sort == "reference":
        return Effect(note="none on a computed result: the reader is sent to the wrong place")
    if finding.verdict is Verdict.SCAN:
        return Effect(note="none: with its characters restored the form is the derived one")
    return Effect(note="none on a computed result")


def stated(finding: Finding) -> Effect:
    """Effect from the `effect` of a relation's entry.

    Notes
    -----
    `variants`: [label, stage or "both", factor of the resistance]; `numbers`: [what, formula]; `settings`: [label, case parameter,
    value]; `swapped`: the label of stages changing places; `note`. In their formulas `printed`, `derived` and `reading` are the right-
    hand sides: as printed, as derived, and in the second reading.
    """
    data, first = finding.relation.effect, finding.first
    forms: dict[str, Callable[[], sp.Expr]] = {
        "printed": lambda: first.reading.formula.value, "derived": lambda: first.derivation.result,
        "reading": lambda: finding.judged[1].reading.formula.value,
    }  # fmt: skip

    def value(text: str) -> sp.Expr:
        found = sp.sympify(Formula(text).value)
        return found.subs({symbol: forms[symbol.name]() for symbol in found.free_symbols if symbol.name in forms})

    variants = [
        Variant(label, {s: on_path(sp.simplify(value(text))) for s in ((SQUEEZE, BLEED) if stage == "both" else (stage,))})
        for label, stage, text in data.get("variants", ())
    ]
    if "settings" in data:
        label, name, text = data["settings"]
        variants.append(Variant(label, settings={name: value(text)}))
    if "swapped" in data:
        variants.append(Variant(data["swapped"], swapped=True))
    numbers = tuple((what, value(text)) for what, text in data.get("numbers", ()))
    return Effect(tuple(variants), numbers, data.get("note", ""))


def on_path(expr: sp.Expr) -> sp.Expr:
    """Invariants in pure squeezing by eps: J = 1, C11 = exp(2 eps), I1 - 1 = C11 + 1/C11, I3 = 1."""
    i1, i3, x, J, c11, lam, eps, eps_dot, cdot11, i1b = sym("I1 I3 I1s J C11 lam eps eps_dot Cdot11 I1b")
    square = sp.exp(2 * eps)
    state = {i1: 1 + square + 1 / square, i3: 1, x: square, i1b: square, J: 1, c11: square, lam: sp.exp(eps)}
    return sp.powsimp(expr.subs(cdot11, 2 * c11 * eps_dot).subs(state))


def _potential_squeezing(finding: Finding) -> Effect:
    printed, derived = finding.first.reading.formula.value, finding.first.derivation.result
    parts = {"all of Eq. 13 as printed": (printed, derived)}
    parts |= {f"only the {name} as printed": (part, wanted) for name, part, wanted in finding.faults}
    return Effect(tuple(Variant(label, {SQUEEZE: on_path(part / wanted)}) for label, (part, wanted) in parts.items()))


def _bleeding_i1(finding: Finding) -> Effect:
    chi_l, i1b, k, chi_f, c11, a = sym("chi_l I1b k chi_f C11 a")
    wrong = sp.expand(finding.first.reading.formula.value - (1 + chi_l))
    potential = (1 / i1b) * (k / (sp.sqrt(i1b) - k / sp.sqrt(chi_f))) ** 2 * (1 / (2 * i1b**2)) ** ((a + 2) / 2)
    ratio = potential.subs(i1b, wrong) / potential.subs(i1b, c11)
    variant = Variant("Eq. 14 with $I1b$ from the printed $I1$", {BLEED: on_path(ratio)}, sp.sqrt(k / sp.sqrt(chi_f)))
    return Effect((variant,))


def _elastic(finding: Finding) -> Effect:
    forms = finding.first.reading.formula.value, finding.first.derivation.result
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


def _tangent(finding: Finding) -> Effect:
    forms: tuple[Value, ...] = (finding.first.reading.formula.value, finding.first.derivation.result)
    viscous = [form[0, 1, 0, 1].subs(sp.Symbol("Ce_1212", real=True), 0) for form in forms]
    ratio = sp.simplify(viscous[0] / viscous[1])
    numbers = (
        ("viscous tangent as printed over derived", ratio),
        ("factor of a Newton error per iteration", 1 - 1 / ratio),
    )
    note = "no solution by Newton's method where viscosity governs: an error changes sign and keeps its size"
    return Effect(numbers=numbers, note=note)


def _indefinite(finding: Finding) -> Effect:
    steps = finding.first.derivation.steps
    minors = [sp.sympify(step.value) for step in steps if step.text.startswith("leading minor")]
    smallest = ("smallest leading minor of the compliance, one ratio", min(minors))
    note = "no solution: with one Poisson's ratio the potential is not positive definite"
    return Effect(numbers=(smallest,), note=note)


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


_COMPUTED: dict[str, Callable[[Finding], Effect]] = {
    "13": _potential_squeezing, "14-I1": _bleeding_i1, "10": _elastic, "16": _tangent, "T4.definite": _indefinite, "A.1": _shear_angle,
}  # fmt: skip
