"""The model's own expressions beside the audited ones: derived form = what the compiler lowers and emits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from umataudit.identity import Identity, compare
from umataudit.printed.formula import Value
from umataudit.printed.letters import LETTERS, sym, tensor
from umataudit.printed.tables import TABLE_4
from umataudit.printed.tensors import dyad, fourth_order
from umataudit.verdict import Finding
from umatgen import notation
from umatgen.model import elastic, law_1d, tangent, viscous
from umatgen.model.chain import Chain, Definition
from umatgen.model.generators import C_INVERSE, C_RATE, KIRCHHOFF, ONE, derivative_rules, gradient_rules, odot
from umatgen.model.kinematics import mohr_definitions


@dataclass(frozen=True)
class Registered:
    """A model expression and what came of comparing it with the audited form."""

    name: str
    identity: Identity


Pairs = list[tuple[str, Value, Value]]
_LINKS: dict[str, Callable[[Value], Pairs]] = {}


def registers(*relation_ids: str) -> Callable[[Callable[[Value], Pairs]], Callable[[Value], Pairs]]:
    """Decorator: the function pairs model expressions with the accepted form of these relations."""

    def add(function: Callable[[Value], Pairs]) -> Callable[[Value], Pairs]:
        _LINKS.update(dict.fromkeys(relation_ids, function))
        return function

    return add


def accepted(finding: Finding) -> Value:
    """The form that is taken over: the reading that holds, else the derived form."""
    if finding.passing is not None:
        return finding.passing.reading.formula.value
    return finding.first.derivation.result


def registered(finding: Finding) -> list[Registered]:
    """Comparison of the model's expressions of a relation with its accepted form; empty when the model has none."""
    link = _LINKS.get(finding.relation.id)
    if link is None or accepted(finding) is None:
        return []
    return [
        Registered(name, compare(model, audited, f"registered/{finding.relation.id}/{name}"))
        for name, model, audited in link(accepted(finding))
    ]


def paper_letters(expr: sp.Expr) -> sp.Expr:
    """A model expression in the paper's letters: invariants of A by I1, I3, x; limits written out."""
    x, chi_l, chi_f, k, i1, i3, eps, eps_dot, l0, d, j2 = sym("I1s chi_l chi_f k I1 I3 eps eps_dot l0 d J2")
    root, stretch, gap, norm, ratio, effective, closeness = notation.sym(
        "root_chi_l", "stretch", "gap", "a_norm2", "l0_over_d", "j2_eff", "closeness"
    )
    names = {
        root: sp.sqrt(chi_l), gap: sp.sqrt(x) - k / sp.sqrt(chi_f), norm: (i1 - 1) ** 2 - 2 * i3, ratio: l0 / d,
        law_1d.EPS: eps, law_1d.RATE: -eps_dot, effective: j2, closeness: k / (sp.sqrt(chi_f) * sp.sqrt(x) - k),
    }  # fmt: skip
    return expr.subs(names).subs(stretch, sp.sqrt(x))


@registers("4a", "4b", "5a", "5b")
def _factors(audited: sp.Expr) -> Pairs:
    """The ply term, or the fibre term without the resin viscosity; a bleeding term holds eps_l or l0."""
    eps_l, l0, eta_res, chi_l = sym("eps_l l0 eta_res chi_l")
    stage = "bleed" if audited.has(eps_l) or audited.has(l0) else "squeeze"
    name = "eta_micro" if audited.has(eta_res) else "eta_ply"
    model = paper_letters(getattr(law_1d, name)(stage))
    return [(f"law_1d.{name}('{stage}')", model, audited.subs({eta_res: 1, eps_l: -sp.log(chi_l) / 2}))]


@registers("3")
def _law(audited: sp.Expr) -> Pairs:
    eta_micro, eta_ply, eta_rate, a, b, eps_dot = sym("eta_micro eta_ply eta_rate a b eps_dot")

    def product(stage: str) -> sp.Expr:
        micro, ply = (paper_letters(term(stage)) for term in (law_1d.eta_micro, law_1d.eta_ply))
        return audited.subs({eta_micro: micro, eta_ply: ply, eta_rate: sp.exp(b) * (-eps_dot) ** a})

    return [
        (f"law_1d.compressive_stress('{stage}')", -paper_letters(law_1d.compressive_stress(stage)), product(stage))
        for stage in viscous.STAGES
    ]


@registers("5-chi_l")
def _aspect(audited: sp.Expr) -> Pairs:
    model = Chain(viscous.law_definitions()).expand(notation.sym("chi_l")[0])
    return [("viscous.law_definitions: chi_l", model, audited)]


@registers("10")
def _elastic(audited: sp.Expr) -> Pairs:
    return [("elastic.potential", elastic.potential(), audited)]


@registers("T4.G23")
def _shear(audited: sp.Expr) -> Pairs:
    e_t, nu_tt, mu_t = notation.sym("e_t", "nu_tt", "mu_t")
    numbers = {e_t: sp.Rational(TABLE_4["E2"]), nu_tt: sp.Rational(TABLE_4["nu23"])}
    return [("elastic.moduli: mu_T", elastic.moduli()[mu_t].subs(numbers), audited)]


@registers("13", "14")
def _viscous(audited: sp.Expr) -> Pairs:
    i1s, i1b = sym("I1s I1b")
    stage = "bleed" if audited.has(i1b) else "squeeze"
    return [(f"viscous.potential('{stage}')", paper_letters(viscous.potential(stage)), audited.subs(i1b, i1s))]


@registers("15-f")
def _common(audited: sp.Expr) -> Pairs:
    return [
        (f"viscous.potential('{stage}')", paper_letters(viscous.potential(stage)), _with_f(audited, stage))
        for stage in viscous.STAGES
    ]


def _with_f(audited: sp.Expr, stage: str) -> sp.Expr:
    return audited.subs(sym("f")[0], paper_letters(viscous.factor_f(stage)))


@registers("13-I1s")
def _smallest(audited: sp.Expr) -> Pairs:
    """With the transverse block diagonal in C22, C33: model's x, and I1^s with I1 - 1 = tr A, I3 = det A."""
    (a22, a33, a23, x_end), (i1, i3) = notation.sym("a22", "a33", "a23", "x_end"), sym("I1 I3")
    model = Chain(mohr_definitions()).expand(x_end)
    mine = audited.subs({i1: 1 + a22 + a33, i3: a22 * a33 - a23**2})
    return [("kinematics: x_end, the smallest eigenvalue", _expand_roots(model), _expand_roots(mine))]


def _expand_roots(expr: sp.Expr) -> sp.Expr:
    """Square roots with expanded, primitive arguments."""
    roots = {p: sp.sqrt(sp.factor(sp.expand(4 * p.base))) / 2 for p in expr.atoms(sp.Pow) if p.exp == sp.Rational(1, 2)}
    return sp.expand(expr.xreplace(roots))


@registers("15")
def _stress(audited: sp.Expr) -> Pairs:
    """The factor g of the model, (a + 2) f J2^(a/2) in Eq. 15, for both stages."""
    elastic_part = dict.fromkeys(tensor("Se").free_symbols, 0)
    factor = sp.simplify(audited[0, 1].subs(elastic_part) / tensor("Cdot")[0, 1])
    model = {stage: paper_letters(sp.exp(viscous.log_viscous_factor(stage))) for stage in viscous.STAGES}
    return [(f"viscous.log_viscous_factor('{stage}')", g, _with_f(factor, stage)) for stage, g in model.items()]


@registers("8", "9")
def _gradients(audited: sp.Expr) -> Pairs:
    """Rules dI/dC of the model, fibre along axis 1, by differentiation component by component."""
    c, (stretch,) = tensor("C"), notation.sym("stretch")
    determinant = c.det(method="berkowitz")
    n, cofactors = sp.diag(1, 0, 0), c.adjugate()
    x = determinant / cofactors[2, 2]
    forms = {
        "b_left": sp.eye(3), "fibre": n, "fibre_c": n * c + c * n, "unit": cofactors / determinant,
        "m22": sp.diag(0, 1, 0), "m33": sp.diag(0, 0, 1), "m23": sp.Matrix([[0, 0, 0], [0, 0, 1], [0, 1, 0]]),
    }  # fmt: skip
    forms["normal"] = x * cofactors[:, 2] * cofactors[2, :] / determinant**2
    forms["transverse"] = sp.diag(0, 1, 1) * c * sp.diag(0, 1, 1)
    forms["plane"] = forms["unit"] - forms["normal"]
    values = {"x_end": x, "i1": c.trace(), "i4": c[0, 0], "i5": (c * c)[0, 0], "a22": c[1, 1], "a33": c[2, 2], "a23": c[1, 2]}
    values["a_norm2"] = c[1, 1] ** 2 + c[2, 2] ** 2 + 2 * c[1, 2] ** 2
    squares = {"det_f": ("J", determinant), "area": ("A", cofactors[2, 2])}
    pairs: Pairs = []
    for invariant, rule in gradient_rules().items():
        if invariant.name in values:
            parts = (weight.subs(stretch, sp.sqrt(x)) * forms[g.key] for g, weight in rule.items())
            model = sum(parts, sp.zeros(3))
            pairs.append((f"generators: d{invariant.name}/dC", model, _gradient(values[invariant.name], c)))
        elif invariant.name in squares:
            ((g, weight),) = rule.items()
            letter, square = squares[invariant.name]
            model = (2 * invariant * weight).subs(invariant, sp.sqrt(square)) * forms[g.key]
            pairs.append((f"generators: d{letter}/dC", model, _gradient(square, c)))
    return pairs


def _gradient(value: sp.Expr, c: sp.Matrix) -> sp.Matrix:
    return sp.Matrix(3, 3, lambda i, j: sp.diff(value, c[i, j]) / (1 if i == j else 2))


@registers("16")
def _tangent(audited: sp.Expr) -> Pairs:
    """Viscous part of the model's tangent with f held fixed, g = (a+2) f J2^(a/2)."""
    f, a, j2 = sym("f a J2")
    cdot = tensor("Cdot")
    variable, effective, g = notation.sym("j2", "j2_eff", "g_visc")
    chain = Chain([Definition(effective, variable, "15")])
    slope = chain.derivative(viscous.log_viscous_factor("squeeze"), variable).subs(effective, j2)
    (weight,) = tangent.viscous_gradient([variable], chain).values()
    weight = weight.subs(tangent.slope_name(variable), slope)
    rules = derivative_rules()[C_RATE]
    product = sum(2 * w for pair, w in rules.items() if pair == (ONE, ONE))
    identity = fourth_order(lambda i, j, k, m: odot(sp.eye(3), sp.eye(3), i, j, k, m))
    model = (dyad(cdot, cdot) * weight + identity * product) * g
    model = model.subs(g, (a + 2) * f * j2 ** (a / 2)).subs(notation.sym("dt_rate")[0], sym("dt")[0])
    elastic_part = dict.fromkeys(LETTERS["Ce"].value.free_symbols, 0)
    return [("tangent.viscous_gradient, viscous_products", model, audited.subs(elastic_part))]


@registers("17-C'")
def _jaumann(audited: sp.Expr) -> Pairs:
    """2 I (.) tau over J."""
    J = sym("J")[0]
    tau = J * tensor("stress")
    ((pair, weight),) = tangent.jaumann_terms().products.items()
    assert pair == (C_INVERSE, KIRCHHOFF)
    model = fourth_order(lambda i, j, k, m: weight * odot(sp.eye(3), tau, i, j, k, m) / J)
    return [("tangent.jaumann_terms", model, audited)]
