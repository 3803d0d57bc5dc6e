"""What rests on what, where equations hold, and what an auditor asks next: against values worked out here, and altered."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest
from alterations import finding

from plyflow.audit.asked import Answer
from plyflow.audit.consequence import Consequences
from plyflow.audit.creep import reference_case
from plyflow.audit.report import Audit
from plyflow.audit.shown import page
from umataudit import judge
from umataudit.derive import derivation
from umataudit.domain import extensions, places, shear_share
from umataudit.printed import PAPER, Book
from umataudit.printed.tables import TABLE_4
from umataudit.verdict import ShownError, edges
from umatgen.notation import sym

_PAIRS = [
    (user, source)
    for user in PAPER for source in sum(edges(user, PAPER), ())
    if user != source and PAPER[source].readings and PAPER[user].readings
]  # fmt: skip


def altered(book: Book, *relation_ids: str) -> Book:
    """The book with the last reading of each relation a quarter larger."""
    for relation_id in relation_ids:
        index = len(book[relation_id].readings) - 1
        text = book[relation_id].readings[index].formula.text
        book = book.with_relation(book[relation_id].with_formula(index, f"{text}*(5/4)"))
    return book


@pytest.mark.parametrize(("user", "source"), _PAIRS)
def test_two_formulas_altered_at_once_are_seen_or_marked_as_circular(user: str, source: str) -> None:
    seen = any(changed(key, frozenset({user, source}) & {key, *finding(key).reads}) for key in (user, source))
    assert seen or finding(user).circle or finding(source).circle


@cache
def changed(relation_id: str, sources: frozenset[str]) -> bool:
    """Whether a relation's outcome is another when those formulas are altered that it has or reads."""
    book, before = altered(PAPER, *sources), finding(relation_id)
    try:
        after = judge(book[relation_id], book)
    except ShownError:
        return True  # what is derived is no longer what is shown
    holds = [[judged.holds for judged in found.judged] for found in (before, after)]
    return holds[0] != holds[1] or before.first.derivation.result != after.first.derivation.result


def test_the_constant_of_5a_and_13_altered_together_shows_their_circle() -> None:
    book = PAPER
    for key in ("5a", "13"):
        for index, reading in enumerate(PAPER[key].readings):
            text = reading.formula.text.replace("+ 3)", "+ 4)").replace("3*chi_f", "4*chi_f")
            book = book.with_relation(book[key].with_formula(index, text))
    assert judge(book["5a"], book).circle.startswith("consistent with 13, but circular")
    assert not judge(book["W-5a"], book).first.holds  # the witness from outside sees it


def test_4a_and_table_1_altered_together_are_seen_by_the_flow_they_come_from() -> None:
    book = PAPER
    for key in ("4a", "T1.1"):
        for index, reading in enumerate(PAPER[key].readings):
            text = reading.formula.text.replace("-4*eps", "-3*eps").replace("-2*eps", "-3*eps")
            book = book.with_relation(book[key].with_formula(index, text))
    assert judge(book["4a"], book).passing is None
    assert judge(book["T1.1"], book).passing is None


def test_the_matrix_marks_the_circular_entries(audited: Audit) -> None:
    assert {row.id for row in audited.rows if row.circular} == {"5a", "5b", "5-k", "A.1-alpha", "A.1-Vf"}
    html = page(audited).html()
    assert html.count("\u21ba") >= 5
    assert html.count("\u25cf") > 50
    assert html.count("\u25cb") > 20


def answer(audited: Audit, part: str) -> Answer:
    """The answer to the one question that has these words."""
    (found,) = [a for a in audited.answers if part in a.question]
    return found


@pytest.mark.parametrize(("part", "holds"), [
    ("dissipation", True), ("$psi_v$ convex", True), ("objective", True), ("symmetry of fibre and normal", True),
    ("transversely isotropic", False), ("gradient of $psi_v$ in the increment", False),
    ("rank-one", False), ("(bdf1)", False), ("creep-exact mean", True), ("Eq. 16", False),
])  # fmt: skip
def test_questions_are_answered(audited: Audit, part: str, holds: bool) -> None:
    assert answer(audited, part).holds is holds


def test_the_numbers_behind_the_answers(audited: Audit) -> None:
    assert "solutions: 3" in answer(audited, "(bdf1)").answer
    assert "solutions: 1" in answer(audited, "creep-exact").answer
    assert f"-{0.495e-6 / 25:.3g}" in answer(audited, "rank-one").answer
    order = float(answer(audited, "Eq. 16").answer.split("order ")[1].split()[0])
    assert order == pytest.approx(1.0, abs=0.05)


def test_printed_invariants_see_a_compaction_in_an_axial_shear() -> None:
    found = {place.state: place for place in places()}
    sheared, trace = found["axial shear 0.3"], 2 + 0.3**2
    assert sheared.emitted == pytest.approx(0.0, abs=1e-15)
    assert sheared.squeeze == pytest.approx(math.log((trace - math.sqrt(trace**2 - 4)) / 2) / 2)
    assert sheared.squeeze == pytest.approx(-0.149, abs=5e-4)
    assert found["dilation of 0.1 %"].squeeze is None
    squeezed = found["squeezing to $h/h0 = 0.95$, $J = 1$"]
    assert squeezed.met == {"13", "4a", ""}
    assert replace(squeezed, norm=1.1).met == {"4a", ""}
    assert replace(squeezed, width=1.0).met == {"13", ""}
    assert "13" not in replace(sheared, norm=1.0).met


def test_the_matrix_has_what_each_derivation_read(audited: Audit) -> None:
    """Noted while deriving: the circle of 5a and 13, the tables, and nothing of an entry that stands for itself."""
    reads = {row.id: set(row.reads) for row in audited.rows}
    assert reads["5a"] == {"5-k", "13"}
    assert reads["13"] == {"4a", "5a"}
    assert reads["4a"] == set()
    assert {key for key, found in reads.items() if "Table 4" in found} == {"T4.E3", "T4.nu13", "T4.G12", "T4.G23", "T4.definite"}
    assert all(set(row.reads) <= set(row.rests_on) for row in audited.rows)


REPEATS = {"T4.E3": "E2", "T4.nu13": "nu12", "T4.G12": "G13"}


def test_table_and_text_altered_together_are_seen_where_they_do_not_repeat_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cell and the entry that repeats it: only what else reads the cell can see that; k of Tables 2, 3 beside its text is seen."""
    seen_by = {"E2": "T4.G23", "nu12": "T4.definite"}
    as_printed = {other: steps(other) for other in ("T4.G23", "T4.definite")}
    for key, cell in REPEATS.items():
        with monkeypatch.context() as patch:
            patch.setitem(TABLE_4, cell, f"{float(TABLE_4[cell]) * 1.25:.6g}")
            assert judge(PAPER[key], PAPER).passing is None  # alone
            assert judge(altered(PAPER, key)[key], PAPER).passing is not None  # together, the entry is as it was
            others = [other for other, values in as_printed.items() if steps(other) != values]
            assert (seen_by.get(cell) in others) if cell in seen_by else others == []
    columns = tuple(replace(column, k=str(float(column.k) * 1.05)) for column in derivation.COLUMNS)
    monkeypatch.setattr(derivation, "COLUMNS", columns)
    text = altered(PAPER, "T2-3.Vf")
    assert judge(text["T2-3.Vf"], text).passing is None


def steps(relation_id: str) -> list[object]:
    """Values of the steps of a derivation as things stand."""
    return [step.value for step in judge(PAPER[relation_id], PAPER).first.derivation.steps]


def test_the_extensions_have_their_numbers(audited: Audit) -> None:
    said = " ".join(" ".join(entry) for entry in audited.extensions)
    assert "$eps = -0.149$" in said
    assert f"{(15 / 0.5) ** 2 / 2:.0f} times" in said
    assert "nothing but viscosity holds the width" in said
    law = reference_case().law
    strain = Consequences().derived.strain
    h, w = math.exp(strain), math.exp(-law.eps_lock)
    assert f"{(h / w) ** 4:.2g} times as fast" in said  # sigma = 2 g C^2 d/J along each axis
    assert "held by a constraint" in extensions(15.0, 0.5, law.eps_lock, strain, True)[3][0]


def test_a_shear_meets_half_the_squared_ratio_of_width_to_thickness() -> None:
    w0, h0 = sym("w0", "h0")
    assert shear_share() == w0**2 / (2 * h0**2)


def test_every_registered_equation_has_a_domain(audited: Audit) -> None:
    rows = {row.id: row for row in audited.rows}
    assert len(rows["15"].holds_in) == len(places())
    assert len(rows["10"].holds_in) == len(places())  # the trace of C whatever the state
    assert {rows[key].premise for key in ("13", "13-I1s")} == {"13"}
    assert all("shear" not in state for state in rows["13"].holds_in)
    assert rows["4a"].premise == rows["5a"].premise == "4a"
    assert rows["14"].holds_in == ["bleeding to $h/h0 = 0.8$, width of the lock"]
    assert all(row.holds_in for row in audited.rows if any("registered" in line.said for line in row.chain[1:2]))


def test_the_page_can_be_filtered_by_verdict(audited: Audit) -> None:
    text = page(audited).html()
    assert text.count('type="radio"') == len(audited.counts) + 1
    assert "<script" not in text
