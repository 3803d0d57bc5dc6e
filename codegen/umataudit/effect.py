"""What a printed form would do if it were used: its resistance to compaction over that of the derived form, and numbers.

Symbolic only; `plyflow.audit` puts the numbers of a case in and computes stress ratio and final thickness.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import sympy as sp

from umataudit.printed.formula import Value
from umataudit.printed.letters import sym
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
    """

    variants: tuple[Variant, ...] = ()
    numbers: tuple[tuple[str, sp.Expr], ...] = ()
    note: str = ""


_Maker = Callable[[Finding], Effect]
_MAKERS: dict[str, _Maker] = {}


def effect_of(*relation_ids: str) -> Callable[[_Maker], _Maker]:
    """Decorator: the function states the effect of these relations."""

    def add(function: _Maker) -> _Maker:
        for relation_id in relation_ids:
            _MAKERS[relation_id] = function
        return function

    return add


def effect(finding: Finding) -> Effect:
    """Effect of the first reading of a relation; nothing when it follows."""
    if finding.verdict is Verdict.FOLLOWS:
        return Effect(note="none: the printed form is the derived one")
    maker = _MAKERS.get(finding.relation.id)
    if maker is not None:
        return maker(finding)
    if finding.relation.id.startswith("ref-"):
        return Effect(note="none on a computed result: the reader is sent to the wrong place")
    if finding.first.reading.kind == "ocr":
        return Effect(note="none: a character damaged in the recovered text, the other reading is the derived form")
    return Effect(note="none on a computed result")


def _printed(finding: Finding, reading: int = 0) -> Value:
    return finding.judged[reading].reading.formula.value


def _derived(finding: Finding) -> Value:
    return finding.first.derivation.result


def on_path(expr: sp.Expr) -> sp.Expr:
    """Invariants in pure squeezing by eps: J = 1, C11 = exp(2 eps), I1 - 1 = C11 + 1/C11, I3 = 1."""
    i1, i3, x, J, c11, lam, eps, eps_dot, cdot11, i1b = sym("I1 I3 I1s J C11 lam eps eps_dot Cdot11 I1b")
    square = sp.exp(2 * eps)
    state = {i1: 1 + square + 1 / square, i3: 1, x: square, i1b: square, J: 1, c11: square, lam: sp.exp(eps)}
    return sp.powsimp(expr.subs(cdot11, 2 * c11 * eps_dot).subs(state))


@effect_of("13")
def _potential_squeezing(finding: Finding) -> Effect:
    whole = Variant("all of Eq. 13 as printed", {SQUEEZE: on_path(_printed(finding) / _derived(finding))})
    singles = [
        Variant(f"only the {name} as printed", {SQUEEZE: on_path(part / wanted)})
        for name, part, wanted in finding.faults
    ]
    return Effect((whole, *singles))


@effect_of("12-J2", "14-J2")
def _rate_invariant(finding: Finding) -> Effect:
    a = sym("a")[0]
    stage = SQUEEZE if finding.relation.id == "12-J2" else BLEED
    ratio = (_derived(finding) / _printed(finding, -1)) ** ((a + 2) / 2)
    return Effect((Variant("potential built with the printed J2 (with its dot)", {stage: on_path(ratio)}),))


@effect_of("14-I1")
def _bleeding_i1(finding: Finding) -> Effect:
    chi_l, i1b, k, chi_f, c11, a = sym("chi_l I1b k chi_f C11 a")
    wrong = sp.expand(_printed(finding) - (1 + chi_l))
    potential = (1 / i1b) * (k / (sp.sqrt(i1b) - k / sp.sqrt(chi_f))) ** 2 * (1 / (2 * i1b**2)) ** ((a + 2) / 2)
    ratio = potential.subs(i1b, wrong) / potential.subs(i1b, c11)
    limit = sp.sqrt(k / sp.sqrt(chi_f))
    return Effect((Variant("Eq. 14 with I1^b from the printed I1", {BLEED: on_path(ratio)}, limit=limit),))


@effect_of("10")
def _elastic(finding: Finding) -> Effect:
    mu_l, lam, i4, i5, J, i1 = sym("mu_L lam_e I4 I5 J I1")
    natural = {i1: 3, i4: 1, i5: 1, J: 1}

    def along(potential: sp.Expr) -> sp.Expr:
        rates = {i1: 2, i4: 2, i5: 4, J: 1}
        return sp.factor(sum(sp.diff(potential, i).subs(natural) * rate for i, rate in rates.items()))

    def coupling(potential: sp.Expr) -> sp.Expr:
        return lam + 2 * sp.diff(potential, i4, J).subs(natural)

    printed, derived = _printed(finding), _derived(finding)
    return Effect(
        numbers=(
            ("stress along the fibre at F = 1 as printed [MPa]", along(printed)),
            ("the same, derived [MPa]", along(derived)),
            ("it over mu_L, as printed", along(printed) / mu_l),
            ("stiffness 1122 as printed over derived", coupling(printed) / coupling(derived)),
        ),
        note="thickness unchanged: in compaction the fibre is held and the moduli of Table 4 (1e-6 MPa) carry no load; "
        "a free body would not rest at F = 1",
    )


@effect_of("16")
def _tangent(finding: Finding) -> Effect:
    name = sp.Symbol("Ce_1212", real=True)
    viscous = [value[0, 1, 0, 1].subs(name, 0) for value in (_printed(finding), _derived(finding))]
    ratio = sp.simplify(viscous[0] / viscous[1])
    return Effect(
        numbers=(
            ("viscous tangent as printed over derived", ratio),
            ("factor of a Newton error per iteration", 1 - 1 / ratio),
        ),
        note="no solution by Newton's method where viscosity governs: an error changes sign and keeps its size",
    )


@effect_of("17-push")
def _push(finding: Finding) -> Effect:
    return Effect(note="no solution: index l stands three times, so the expression has no value")


@effect_of("3.2-b", "2", "12")
def _resin(finding: Finding) -> Effect:
    b, b_bar, eta_res = sym("b b_bar eta_res")
    if finding.relation.id == "3.2-b":
        wrong = _printed(finding).subs(b_bar, b - sp.log(eta_res))
        label, factor = "b as the product", sp.exp(wrong - b)
    else:
        label, factor = "resin viscosity in eta_micro and in exp(b)", eta_res
    factor = factor.subs(eta_res, sp.Rational(1, 100000))
    note = "stated state: eta_resin = 1e-5 MPa s (10 Pa s), which the paper does not give"
    return Effect((Variant(label, {SQUEEZE: factor, BLEED: factor}),), note=note)


@effect_of("5-increase")
def _increase(finding: Finding) -> Effect:
    return Effect(note="none on a computed result; taken for the stress, with the b of Tables 2, 3, it drops (5-lock)")


@effect_of("5-lock")
def _jump(finding: Finding) -> Effect:
    X, a = sym("X a")
    drop = X**2 / (X**2 + 3)
    numbers = (
        ("stress ratio at locking, derived", drop),
        ("jump of the creep rate there", (1 / drop) ** (1 / (a + 1))),
    )
    return Effect((Variant("no drop at locking", {BLEED: 1 / drop}),), numbers)


@effect_of("4.4-rule")
def _swapped(finding: Finding) -> Effect:
    return Effect((Variant("the rule as printed: bleeding first, squeezing after", swapped=True),))


@effect_of("A.1")
def _no_angle(finding: Finding) -> Effect:
    v0 = sp.Rational(1, 2)
    bulk = sp.Rational(2, 3) * sp.log(sp.sqrt(4 * v0 / sp.pi))
    note = "no solution: without gamma_lock Eq. 6 has no value; the variant keeps its second member alone"
    return Effect((Variant("eps_l from the bulk alone, eps_lock = ln sqrt(4 V0/pi) assumed", lock=bulk),), note=note)


@effect_of("A.1-A0")
def _whole_cell(finding: Finding) -> Effect:
    p = 4 * sp.pi / (4 * sp.Rational(1, 2))
    return Effect(numbers=(("smallest argument of the arcsine of A.1 with a whole cell", (p - 1 / p) / 2),))


@effect_of("A.1-Vf")
def _limit_fraction(finding: Finding) -> Effect:
    v0 = sym("V0")[0]
    derived = _derived(finding).subs(v0, sp.Rational(1, 2))
    return Effect(
        numbers=(("V_f as printed", _printed(finding)), ("V_f at which Eq. 5b is singular", derived)),
        note="thickness unchanged: V_f enters Eq. A.1 alone",
    )


@effect_of("A.1-trend")
def _trend(finding: Finding) -> Effect:
    return Effect(numbers=(("fibre fraction at the end, from 0.5", sp.Symbol("fraction_at_end", positive=True)),))


@effect_of("T4.G23")
def _shear_modulus(finding: Finding) -> Effect:
    return Effect(
        numbers=(("G23 as printed over derived", _printed(finding) / _derived(finding)),),
        note="thickness unchanged: no shear across the fibre in compaction",
    )


@effect_of("T4.definite")
def _indefinite(finding: Finding) -> Effect:
    steps = finding.first.derivation.steps
    minors = [sp.sympify(step.value) for step in steps if step.text.startswith("leading minor")]
    return Effect(
        numbers=(("smallest leading minor of the compliance, one ratio [1/MPa^n]", min(minors)),),
        note="no solution: with one Poisson's ratio the potential is not positive definite",
    )


@effect_of("T1.1", "4a", "4-power", "4b")
def _ply(finding: Finding) -> Effect:
    micro = sym("eta_micro")[0]
    derived = _derived(finding).subs(micro, 1)
    printed = _printed(finding).subs(micro, 1)
    stage = BLEED if finding.relation.id == "4b" else SQUEEZE
    if finding.relation.id == "T1.1":
        return Effect((Variant("exponent of Table 1 in place of Eq. 4a", {stage: sp.powsimp(printed / derived)}),))
    label = "what follows literally, with b kept"
    return Effect((Variant(label, {stage: sp.powsimp(sp.expand_power_base(derived / printed, force=True))}),))


@effect_of("4.3-stress")
def _one_component(finding: Finding) -> Effect:
    i3 = sym("I3")[0]
    ratio = sp.simplify(_derived(finding) / _printed(finding)).subs(i3, 1)
    return Effect((Variant("sigma_11 alone taken for the stress of Eq. 1", {SQUEEZE: on_path(ratio)}),))


@effect_of("5-chi_f")
def _aspect(finding: Finding) -> Effect:
    return Effect((Variant("chi_l/chi_f = 5/7 in place of 0.7", settings={"chi_ratio": _derived(finding)}),))


@effect_of("2-duration")
def _duration(finding: Finding) -> Effect:
    return Effect((Variant("load removed after 15 min", settings={"end_time": _printed(finding)}),))


@effect_of("13-real")
def _not_real(finding: Finding) -> Effect:
    delta = sym("delta")[0]
    under = -(delta**2) * (3 + 4 * delta)
    return Effect(
        numbers=(("number under the root at delta = 0.001", under.subs(delta, sp.Rational(1, 1000))),),
        note="no solution: the root is not a number for a dilation, however small",
    )


@effect_of("T2-3.b")
def _sets(finding: Finding) -> Effect:
    return Effect(note="none on a computed result: one b and the constant, read as (l0/d)^2, give both rows")
