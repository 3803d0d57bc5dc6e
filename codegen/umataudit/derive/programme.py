"""Section 2 and the cross-references: arithmetic of the programme; which equation holds what a reference names."""

from __future__ import annotations

import re

import sympy as sp

from umataudit.derive.derivation import Defined, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import LETTERS, sym


@derives("2-level")
def last_level(printed: Printed) -> Derivation:
    """Fifth of five levels."""
    result = sp.Integer(80) + 4 * sp.Integer(40)
    return equals(printed, result, (Defined("five steps, the first 80 N, increment 40 N"),), (Step("80 N + 4 x 40 N", result),))


@derives("2-pressure")
def equal_pressure(printed: Printed) -> Derivation:
    """Force over plate area."""
    result = (sp.Rational(60) / 15**2) / (sp.Rational(240) / 30**2)
    steps = (Step("60 N on 15 mm squared over 240 N on 30 mm squared", result),)
    return equals(printed, result, (Defined("plate area $w0 w0$"),), steps)


@derives("2-duration")
def duration(printed: Printed) -> Derivation:
    """Both loadings take 1200 s."""
    result = sp.Integer(1200)
    return equals(printed, result, ("'loaded to 60 N in 1200 s'",), (Step("1200 s in minutes", result / 60),))


_TARGETS = {
    "ref-ab": ("gives the rate factor and holds both $a$ and $b$", "eta_rate", "a b"),
    "ref-sigma": ("gives the Cauchy stress of both potentials", "stress", ""),
    "ref-integrate": ("gives a gradient of $psi_v$, holds $eta_micro$, $eta_ply$, $a$ and $b$", "dpsi_v_11", "eta_micro eta_ply a b"),
    "ref-lock": ("gives the strain at locking", "eps_l", ""),
}
"""By reference: what the sentence says of the equation, its left-hand side, and letters that it holds."""


def _holds(printed: Printed, relation_id: str, left: str, letters: str) -> bool:
    """Whether the first reading of a relation gives a letter and holds the others, its left-hand side included."""
    relation = printed.look_up(relation_id)
    value = relation.readings[0].formula.value
    found = set() if hasattr(value, "tolist") else value.free_symbols
    if relation.left and not LETTERS[relation.left].shape:
        found = found | {LETTERS[relation.left].symbol}
    return relation.left == left and set(sym(letters)) <= found


@derives(*_TARGETS)
def referenced_equation(printed: Printed) -> Derivation:
    """The one numbered equation that holds what the text names."""
    said, left, letters = _TARGETS[printed.relation.id]
    numbered = {str(n): [str(n)] for n in range(1, 16)} | {"4": ["4a", "4b"], "5": ["5a", "5b"]}
    found = [number for number, ids in numbered.items() if any(_holds(printed, id_, left, letters) for id_ in ids)]
    if len(found) != 1:
        return Derivation((said,), (), (), missing=f"{len(found)} equations fit: {', '.join(found)}")
    result = sp.Integer(int(found[0]))
    steps = (Step(f"the only numbered equation that {said}", result),)
    return equals(printed, result, ("what the sentence names",), steps)


@derives("ref-tables")
def referenced_tables(printed: Printed) -> Derivation:
    """The tables with k, a and b are the second and third."""
    tables = sorted({2 if column.material == "IM7-8552" else 3 for column in printed.columns})
    result = sp.Integer(sum(tables))
    steps = (Step(f"tables with values of $k$, $a$ and $b$: {' and '.join(map(str, tables))}"), Step("sum of their numbers", result))
    return equals(printed, result, ("the parameters $k$, $a$, $b$",), steps)


@derives("ref-invariants")
def invariants_in_numbered_equations(printed: Printed) -> Derivation:
    """The equation beside which the lines that define I2 and I3 stand; no numbered one has an invariant on its left."""
    places = [r.place for r in printed.book.values() if r.defines in {"I1", "I2", "I3", "I4", "I5"}]
    named = {"I1", "I2", "I3", "I4", "I5"} & {printed.book[str(n)].left for n in range(10, 15)}
    result = sp.Integer(max(int(re.findall(r"\d+", place)[-1]) for place in places))
    steps = (
        Step("left-hand sides of Eqs. 10 to 14 that are one of $I1$ to $I5$", sp.Integer(len(named))),
        Step("the definitions stand below Eq.", result),
    )
    return equals(printed, result, ("a definition has its letter on the left",), steps)


@derives("ref-section")
def referenced_section(printed: Printed) -> Derivation:
    """Section in which Eqs. 1 to 6 stand."""
    sections = {printed.book[n].place.removeprefix("section ")[0] for n in ("1", "2", "3", "4a", "4b", "5a", "5b", "6")}
    result = sp.Integer(int(sections.pop())) if len(sections) == 1 else sp.S.Zero
    return equals(printed, result, ("Eqs. 1 to 6 are the 1D model",), (Step("section of Eqs. 1 to 6", result),))
