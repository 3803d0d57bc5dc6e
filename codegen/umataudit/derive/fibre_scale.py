"""Eq. 5 and the cell geometry around it, and the jump of the stress at locking."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym
from umataudit.printed.tables import Column
from umataudit.printed.units import unit_of

_CELL = (
    "unit cell of square fibres; initial aspect ratio 1",
    "$gap/d = (sqrt(chi_f) exp(eps) - k)/k$ and the share of the face: read back from Eq. 5, not given by the paper",
)
_RESIN = "$(l0/d)^2 exp(b_bleed) = exp(b_squeeze)$, as Tables 2, 3 suggest (T2-3.b); the paper does not give $l0/d$"
_ROGERS = "Rogers' expression as Eq. 4 writes it, twice the square of channel length over gap, for the resin between two fibres"


def _gap() -> sp.Expr:
    """Gap between two fibres, from the reading of k."""
    k, chi_f, eps, d = sym("k chi_f eps d")
    return d * (sp.sqrt(chi_f) * sp.exp(eps) - k) / k


def _k_unit(printed: Printed) -> Comparison:
    """Unit of k: that of its printed definition, or none under the reading; it is subtracted from a number."""
    definition = printed.look_up("5-k").readings[-1 if printed.under == "share" else 0].formula
    return Comparison("unit of $k$", unit_of(definition.tree).unit, sp.S.One)


@derives("5a")
def fibre_term_squeezing(printed: Printed) -> Derivation:
    """Resin squeezed across the fibre: 2 (share of the face) (resin) [(d/gap)^2 + constant].

    The constant beside (d/gap)^2 has no derivation in the paper; it has to be a number, and the one of Eq. 13.
    """
    k, chi_l, eps, eta_res, d = sym("k chi_l eps eta_res d")
    share = k * sp.sqrt(chi_l) * sp.exp(eps)
    channel = (d / _gap()) ** 2
    constant = sp.simplify(printed.value / (2 * eta_res * share) - channel)
    in_13 = _constant_of_13(printed)
    result = 2 * eta_res * share * (channel + in_13)
    steps = (
        *_contradiction(),
        Step("channel between two fibres: $(d/gap)^2$", channel),
        Step("share of the cell face that the fibre covers, $k$ at locking, growing as the cell narrows", share),
        Step("what Eq. 5a has beside the channel term", constant),
        Step("the same constant in Eq. 13", in_13),
        Step("$2 eta_res share ((d/gap)^2 + constant)$", result),
    )
    comparisons = (_k_unit(printed), Comparison("right-hand side", printed.value, result))
    missing = "$k$ as defined has a unit, but is subtracted from a number; the paper shows no derivation of the constant 3"
    premises = (*_CELL, _ROGERS, "the constant beside the channel term is that of Eq. 13; the paper derives neither")
    return Derivation(premises, steps, comparisons, result, uses=("5-k",), missing=missing, taken_from=("13", "5a"))


def _contradiction() -> tuple[Step, ...]:
    """What both premises of the cell need, were it square at the start as chi_l = exp(-2 eps_l) has it."""
    k, chi_l, chi_f, eps, d = sym("k chi_l chi_f eps d")
    pitch, width = sp.symbols("p_y p_x", positive=True)
    (along,) = sp.solve(pitch * sp.exp(eps) - d - _gap(), pitch)
    (across,) = sp.solve(d / (width * sp.exp(-eps)) - k * sp.sqrt(chi_l) * sp.exp(eps), width)
    needed = sp.solve(sp.simplify(along / across).subs(chi_f, chi_f) - 1, chi_f)[0] * chi_l
    return (
        Step("fibre distance along the compaction, from the gap", along),
        Step("fibre distance across, from the share of the face", across),
        Step("a cell that is square at the start needs both equal: $chi_l chi_f$ =", sp.simplify(needed)),
        Step("with $chi_l = 0.7 chi_f$, both above 1, it cannot be: the premises contradict each other"),
    )


def _constant_of_13(printed: Printed) -> sp.Expr:
    """Number beside the channel term in the bracket of Eq. 13, over chi_f."""
    k, chi_f, x = sym("k chi_f I1s")
    channel = (k / (sp.sqrt(x) - k / sp.sqrt(chi_f))) ** 2
    bracket = next(f for f in printed.look_up("13").readings[-1].formula.factors() if f.has(chi_f) and f.is_Add)
    return sp.simplify((bracket - channel) / chi_f)


@derives("5b")
def fibre_term_bleeding(printed: Printed) -> Derivation:
    """Resin squeezed along the fibre: 2 (share of the face at locking) (resin) (l0/gap)^2."""
    k, eta_res, l0 = sym("k eta_res l0")
    result = 2 * eta_res * k * sp.expand_power_base((l0 / _gap()) ** 2)
    steps = (
        *_contradiction(),
        Step("channel along the fibre: $(l0/gap)^2$", (l0 / _gap()) ** 2),
        Step("share of the cell face that the fibre covers from locking on", k),
        Step("$2 eta_res share (l0/gap)^2$", result),
    )
    comparisons = (_k_unit(printed), Comparison("right-hand side", printed.value, result))
    missing = "$k$ as defined has a unit, but is subtracted from a number"
    return Derivation((*_CELL, _ROGERS), steps, comparisons, result, uses=("5-k",), missing=missing, taken_from=("14", "5b"))


@derives("5-k")
def definition_of_k(printed: Printed) -> Derivation:
    """The letter k stands beside sqrt(chi_f) exp(eps), a number; of d and a_y the ratio is one."""
    k, eps, d, a_y = sym("k eps d a_y")
    p, q = sp.symbols("p q", integer=True)
    solved = sp.solve([p - 1, p + q], (p, q))
    result = d ** solved[p] * a_y ** solved[q]
    of_centres = sp.solve(_gap() - (a_y * sp.exp(eps) - d), k)[0]
    steps = (
        Step("Eq. 5 subtracts $k$ from $sqrt(chi_f) exp(eps)$: $k$ is a number"),
        Step("$d^p a_y^q$ with $p = 1$ has no unit (mm) when $p + q = 0$", result),
        Step("the gap of Eq. 5 with $a_y$ from centre to centre, $gap = a_y exp(eps) - d$, gives $k$ =", of_centres),
    )
    check = Comparison("unit of $k$", unit_of(printed.reading.formula.tree).unit, sp.S.One)
    premises = ("$k$ is made of $d$ and the fibre distance, proportional to $d$", "lengths in mm")
    comparisons = (check, Comparison("right-hand side", printed.value, result))
    missing = "as printed $k$ has a unit, but is subtracted from a number; the ratio is read back from Eq. 5"
    return Derivation(premises, steps, comparisons, result, missing=missing, taken_from=("5a", "5b"))


@derives("5-chi_l")
def aspect_ratio_at_lock(printed: Printed) -> Derivation:
    """A square cell that deforms with the ply, without change of volume."""
    eps, eps_l = sym("eps eps_l")
    ratio = sp.exp(-eps) / sp.exp(eps)
    result = sp.powsimp(ratio.subs(eps, eps_l))
    steps = (Step("width over height of an initially square cell: $exp(-eps)/exp(eps)$", ratio), Step("at $eps_l$", result))
    return equals(printed, result, ("square cell at the start", "incompressible until locking"), steps, ("4-strain",))


@derives("5-limit")
def aspect_ratio_at_singularity(printed: Printed) -> Derivation:
    """Width over height of the cell, square at the start, where Eq. 5b is singular, its width fixed at the lock."""
    k, chi_l, chi_f = sym("k chi_l chi_f")
    height = k / sp.sqrt(chi_f)
    result = sp.sqrt(chi_l) / height
    (equal,) = sp.solve(result - chi_f, k)
    steps = (
        Step("Eq. 5b is singular at $exp(eps)$ =", height),
        Step("width there, that of the lock, $exp(-eps_l)$", sp.sqrt(chi_l)),
        Step("aspect ratio of the cell", result),
        Step("it is $chi_f$ for one $k$ alone", equal),
        Step("with $chi_l = 0.7 chi_f$ that is $k$ =", sp.N(sp.sqrt(sp.Rational(7, 10)), 5)),
    )
    return equals(printed, result, ("Eq. 5b", "square cell at the start, width fixed at the lock"), steps, ("5b", "5-chi_l"))


@derives("W-5a")
def code_of_the_authors(printed: Printed) -> Derivation:
    """Eq. 5a with exp(eps) = h/h0, the resin viscosity left to b."""
    eps, eta_res, h, h0 = sym("eps eta_res h h0")
    result = sp.simplify((printed.of("5a") / eta_res).subs(eps, sp.log(h / h0)))
    steps = (Step("Eq. 5a over $eta_res$ with $exp(eps) = h/h0$", result),)
    return equals(printed, result, ("Eq. 5a as read here", "the resin viscosity is in $b$ (3.2-b)"), steps, ("5a",))


@derives("5-chi_f")
def aspect_ratio_at_limit(printed: Printed) -> Derivation:
    """The width is fixed after locking, so the aspect ratio goes with the fibre fraction."""
    result = sp.Rational(50, 70)
    steps = [Step("$chi_l/chi_f$, height at the limit over height at locking, is $V0/Vf$", result)]
    if printed.under == "rounded":
        result = sp.Rational(round(float(result) * 10), 10)
        steps.append(Step("to one decimal", result))
    return equals(printed, result, ("fibre fraction 50 % until locking, 70 % at the limit",), tuple(steps))


def lock_ratio(printed: Printed) -> sp.Expr:
    """Bleeding over squeezing stress at locking, same rate, with (l0/d)^2 exp(b_bleed) = exp(b_squeeze) (Tables 2, 3)."""
    eps, eps_l, chi_l, chi_f, k, l0, d, X = sym("eps eps_l chi_l chi_f k l0 d X")
    bleeding, squeezing = (printed.of("4b") * printed.of("5b")), (printed.of("4a") * printed.of("5a"))
    ratio = (bleeding / squeezing * (d / l0) ** 2).subs(eps, eps_l).subs(chi_l, sp.exp(-2 * eps_l))
    root = (k + k / X) * sp.exp(-eps_l)
    return sp.factor(sp.simplify(ratio.subs(chi_f, root**2)))


def _ratios(ratio: sp.Expr, columns: tuple[Column, ...]) -> list[sp.Expr]:
    """A function of X in the columns of Tables 2 and 3, with chi_l = 0.7 chi_f: X = k/(1/sqrt(0.7) - k)."""
    X = sym("X")[0]
    return [ratio.subs(X, k / (1 / sp.sqrt(sp.Rational(7, 10)) - k)) for k in (sp.Rational(c.k) for c in columns)]


@derives("5-lock")
def stress_jump(printed: Printed) -> Derivation:
    """Ratio of the two stresses at locking, and the l0/d that each column would need for none."""
    result = lock_ratio(printed)
    gaps = [sp.Rational(c.b_squeeze) - sp.Rational(c.b_bleed) for c in printed.columns]
    needed = [sp.N(sp.exp(gap / 2) / sp.sqrt(r), 4) for gap, r in zip(gaps, _ratios(result, printed.columns), strict=True)]
    steps = (
        Step("Eqs. 4b 5b over 4a 5a at $eps_l$, with $(l0/d)^2 exp(b_bleed) = exp(b_squeeze)$", result),
        Step("$X = k/(sqrt(chi_f) exp(eps_l) - k)$ is finite, so the ratio is below 1: the stress drops"),
        Step("with another $l0/d$: smallest $l0/d$ that a column of Tables 2, 3 needs for the ratio 1", min(needed)),
        Step("largest; no one $l0/d$ makes the stress continuous in all columns", max(needed)),
    )
    return equals(printed, result, ("Eqs. 4, 5", _RESIN), steps, ("4a", "4b", "5a", "5b", "T2-3.b"))


@derives("5-increase")
def viscosity_change(printed: Printed) -> Derivation:
    """Sign of the change at locking in every column of Tables 2 and 3: of the stress, or of eta_micro alone."""
    fibre_term = printed.under == "fibre term"
    ratio = lock_ratio(printed) * (4 if fibre_term else 1)
    ratios = _ratios(ratio, printed.columns)
    signs = {sp.Integer(1 if value.evalf() > 1 else -1) for value in ratios}
    result = signs.pop() if len(signs) == 1 else sp.S.Zero
    what = "$eta_micro$, Eq. 5b over 5a, for $l0 = 2 d$, its least value" if fibre_term else "bleeding to squeezing stress"
    steps = (
        Step(f"ratio at locking: {what}", ratio),
        Step("$X$ in the tables, with $chi_l = 0.7 chi_f$: $X = k/(1/sqrt(0.7) - k)$; smallest ratio", sp.N(min(ratios), 4)),
        Step("largest ratio in the tables", sp.N(max(ratios), 4)),
    )
    premises = ("Eqs. 4, 5", "a fibre is longer than twice its edge, $l0 > 2 d$" if fibre_term else _RESIN)
    return equals(printed, result, premises, steps, ("5-lock",))


@derives("T2-3.b")
def independent_sets(printed: Printed) -> Derivation:
    """b_squeeze - b_bleed over the columns: one number within the rounding of the tables; or b merely distinct."""
    gaps = [sp.Rational(c.b_squeeze) - sp.Rational(c.b_bleed) for c in printed.columns]
    spread, rounding = max(gaps) - min(gaps), sp.Rational(2, 100)
    free = sp.Integer(1 if spread <= rounding else 2)
    result = sp.Integer(2 if min(gaps) > rounding else 1) if printed.under == "distinct" else free
    mean = sp.Add(*gaps) / len(gaps)
    steps = (
        Step("mean of $b_squeeze - b_bleed$ over the 14 columns", mean),
        Step("largest minus smallest (two roundings to 0.01 allow 0.02)", spread),
        Step("the constant as $(l0/d)^2$, $exp(b_squeeze) = (l0/d)^2 exp(b_bleed)$: $l0/d$", sp.N(sp.exp(mean / 2), 5)),
        Step("$a$ and $k$ have one row for both stages"),
    )
    return equals(printed, result, ("Tables 2, 3, rounded to 0.01",), steps)


@derives("T2-3.Vf")
def share_of_columns(printed: Printed) -> Derivation:
    """Columns above 50 C with 0.6 < k^2 < 0.7."""
    warm = [sp.Rational(c.k) ** 2 for c in printed.columns if c.temperature > 50]
    inside = [v for v in warm if sp.Rational(6, 10) < v < sp.Rational(7, 10)]
    result = sp.Rational(len(inside), len(warm))
    steps = (Step("smallest $k^2$ above 50 C", min(warm)), Step("largest", max(warm)))
    return equals(printed, result, ("$Vf = k^2$", "Tables 2, 3"), steps, ("A.1-Vf",))
