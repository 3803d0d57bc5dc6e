"""Section 2 and the cross-references: arithmetic of the programme; which equation holds what a reference names."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from umataudit.derive.derivation import Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import LETTERS, sym
from umataudit.printed.tables import COLUMNS

_Holds = Callable[[Printed, str], bool]


@derives("2-level")
def last_level(printed: Printed) -> Derivation:
    """Fifth of five levels."""
    result = sp.Integer(80) + 4 * sp.Integer(40)
    return equals(printed, result, ("five steps, the first 80 N, increment 40 N",), (Step("80 N + 4 x 40 N", result),))


@derives("2-pressure")
def equal_pressure(printed: Printed) -> Derivation:
    """Force over plate area."""
    result = (sp.Rational(60) / 15**2) / (sp.Rational(240) / 30**2)
    steps = (Step("60 N/(15 mm)^2 over 240 N/(30 mm)^2", result),)
    return equals(printed, result, ("plate area w0 x w0",), steps)


@derives("2-duration")
def duration(printed: Printed) -> Derivation:
    """Both loadings take 1200 s."""
    result = sp.Integer(1200)
    return equals(printed, result, ("'loaded to 60 N in 1200 s'",), (Step("1200 s in minutes", result / 60),))


def _symbols(printed: Printed, relation_id: str) -> set[sp.Symbol]:
    """Symbols of a relation's first reading, its left-hand side included."""
    relation = printed.book[relation_id]
    value = relation.readings[0].formula.value
    parts = sp.flatten(value.tolist()) if hasattr(value, "tolist") else [value]
    found = {symbol for part in parts for symbol in part.free_symbols}
    if relation.left and not LETTERS[relation.left].shape:
        found.add(LETTERS[relation.left].symbol)
    return found


def _defines(*names: str) -> _Holds:
    wanted = set(sym(" ".join(names)))
    return lambda printed, relation_id: wanted <= _symbols(printed, relation_id)


def _gives(left: str) -> _Holds:
    return lambda printed, relation_id: printed.book[relation_id].left == left


_NUMBERED = {number: (number,) for number in ("1", "2", "3", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15")} | {
    "4": ("4a", "4b"), "5": ("5a", "5b"),
}  # fmt: skip


def _all_of(*conditions: _Holds) -> _Holds:
    return lambda printed, relation_id: all(holds(printed, relation_id) for holds in conditions)


_TARGETS: dict[str, tuple[str, _Holds]] = {
    "ref-ab": ("gives the rate factor and holds both a and b", _all_of(_defines("a", "b"), _gives("eta_rate"))),
    "ref-sigma": ("gives the Cauchy stress of both potentials", _gives("stress")),
    "ref-integrate": (
        "gives a gradient of psi_v and holds eta_micro, eta_ply, a and b",
        _all_of(_defines("eta_micro", "eta_ply", "a", "b"), _gives("dpsi_v")),
    ),
    "ref-lock": ("gives the strain at locking", _gives("eps_l")),
}


@derives(*_TARGETS)
def referenced_equation(printed: Printed) -> Derivation:
    """The one numbered equation that holds what the text names."""
    said, holds = _TARGETS[printed.relation.id]
    found = [number for number, ids in _NUMBERED.items() if any(holds(printed, relation_id) for relation_id in ids)]
    if len(found) != 1:
        return Derivation((said,), (), (), missing=f"{len(found)} equations fit: {', '.join(found)}")
    result = sp.Integer(int(found[0]))
    return equals(
        printed, result, ("what the sentence names",), (Step(f"the only numbered equation that {said}", result),)
    )


@derives("ref-tables")
def referenced_tables(printed: Printed) -> Derivation:
    """The tables with k, a and b are the second and third."""
    tables = sorted({2 if column.material == "IM7-8552" else 3 for column in COLUMNS})
    result = sp.Integer(sum(tables))
    steps = (Step("tables with values of k, a and b", sp.Tuple(*tables)), Step("sum of their numbers", result))
    return equals(printed, result, ("the parameters k, a, b",), steps)


@derives("ref-section")
def referenced_section(printed: Printed) -> Derivation:
    """Section in which Eqs. 1 to 6 stand."""
    sections = {printed.book[n].place.removeprefix("section ")[0] for n in ("1", "2", "3", "4a", "4b", "5a", "5b", "6")}
    result = sp.Integer(int(sections.pop())) if len(sections) == 1 else sp.S.Zero
    return equals(printed, result, ("Eqs. 1 to 6 are the 1D model",), (Step("section of Eqs. 1 to 6", result),))
