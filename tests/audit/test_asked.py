"""What rests on what, where equations hold, and what an auditor asks next: against values worked out here, and altered."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest

from plyflow.audit.asked import Answer
from plyflow.audit.report import Audit
from plyflow.audit.shown import page
from umataudit import Finding, judge
from umataudit.domain import places, shear_share
from umataudit.printed import PAPER, Book
from umataudit.verdict import ShownError, edges
from umatgen.notation import sym

_PAIRS = [
    (user, source)
    for user in PAPER for source in sum(edges(user, PAPER), ())
    if user != source and PAPER[source].readings and PAPER[user].readings
]  # fmt: skip


@cache
def before(relation_id: str) -> Finding:
    """As printed."""
    return judge(PAPER[relation_id], PAPER)


def altered(book: Book, *relation_ids: str) -> Book:
    """The book with the last reading of each relation a quarter larger."""
    for relation_id in relation_ids:
        index = len(book[relation_id].readings) - 1
        text = book[relation_id].readings[index].formula.text
        book = book.with_relation(book[relation_id].with_formula(index, f"{text}*(5/4)"))
    return book


@pytest.mark.parametrize(("user", "source"), _PAIRS)
def test_two_formulas_altered_at_once_are_seen_or_marked_as_circular(user: str, source: str) -> None:
    book = altered(PAPER, user, source)
    try:
        after = {key: judge(book[key], book) for key in (user, source)}
    except ShownError:
        return  # seen: what is derived is no longer what is shown
    seen = any(
        [judged.holds for judged in after[key].judged] != [judged.holds for judged in before(key).judged]
        or after[key].first.derivation.result != before(key).first.derivation.result
        for key in after
    )
    assert seen or before(user).circle or before(source).circle


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
    assert page(audited).html().count("\u21ba") >= 5


def answer(audited: Audit, part: str) -> Answer:
    """The answer to the one question that has these words."""
    (found,) = [a for a in audited.answers if part in a.question]
    return found


@pytest.mark.parametrize(("part", "holds"), [
    ("dissipation", True), ("convex in Cdot", True), ("objective", True), ("symmetry of fibre and normal", True),
    ("transversely isotropic", False), ("rank-one", False), ("(bdf1)", False), ("creep-exact mean", True), ("Eq. 16", False),
])  # fmt: skip
def test_questions_are_answered(audited: Audit, part: str, holds: bool) -> None:
    assert answer(audited, part).holds is holds


def test_the_numbers_behind_the_answers(audited: Audit) -> None:
    assert "3 solution" in answer(audited, "(bdf1)").answer
    assert "1 solution" in answer(audited, "creep-exact").answer
    assert f"-{0.495e-6 / 25:.2g}" in answer(audited, "rank-one").answer
    order = float(answer(audited, "Eq. 16").answer.split("order ")[1].split()[0])
    assert order == pytest.approx(1.0, abs=0.05)


def test_printed_invariants_see_a_compaction_in_an_axial_shear() -> None:
    found = {place.state: place for place in places()}
    sheared, trace = found["axial shear 0.3"], 2 + 0.3**2
    assert sheared.emitted == pytest.approx(0.0, abs=1e-15)
    assert sheared.squeeze == pytest.approx(math.log((trace - math.sqrt(trace**2 - 4)) / 2) / 2)
    assert sheared.squeeze == pytest.approx(-0.149, abs=5e-4)
    assert found["dilation of 0.1 %"].squeeze is None
    assert found["squeezing to h/h0 = 0.95, J = 1"].agrees["squeeze"]
    assert not replace(sheared, norm=1.0).agrees["squeeze"]


def test_a_shear_meets_half_the_squared_ratio_of_width_to_thickness() -> None:
    w0, h0 = sym("w0", "h0")
    assert shear_share() == w0**2 / (2 * h0**2)


def test_every_registered_equation_has_a_domain(audited: Audit) -> None:
    rows = {row.id: row for row in audited.rows}
    assert len(rows["15"].holds_in) == len(places())
    assert rows["13"].printed_in == "I1, I1s, I3"
    assert all("shear" not in state for state in rows["13"].holds_in)
    assert all(row.holds_in for row in audited.rows if any("registered" in line.said for line in row.chain[1:2]))


def test_the_page_can_be_filtered_by_verdict(audited: Audit) -> None:
    text = page(audited).html()
    assert text.count('type="radio"') == len(audited.counts) + 1
    assert "<script" not in text
