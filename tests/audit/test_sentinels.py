"""Every registered relation notices an alteration of its printed form: every number, every sign, a factor of 2."""

from __future__ import annotations

from typing import Any

import pytest
from alterations import alterations, finding

from umataudit import Finding, Verdict, judge
from umataudit.printed import PAPER, Formula, Reading, Relation
from umataudit.render import expression_text

_HOLDS = (Verdict.FOLLOWS, Verdict.READING, Verdict.DEFINITION, Verdict.TAUTOLOGY, Verdict.SCAN)
_FREE_FACTOR = "the reading is 'up to a constant factor': any positive factor passes"
UNSEEN = {
    ("4a", "2 -> 3"): _FREE_FACTOR,
    ("4a", "factor 2"): _FREE_FACTOR,
    ("4b", "2 -> 3"): _FREE_FACTOR,
    ("4b", "factor 2"): _FREE_FACTOR,
}
"""Alterations that a stated reading permits, by relation and beginning of what is altered: the first such only."""
EVALUABLE = {
    "13-real": "1/2*((I1 - 1) - sqrt((I1 - 1)**2 - 3*I3))",
}
"""A form with a value, for each relation that cannot be evaluated as printed."""
FORMED = [key for key, relation in PAPER.items() if relation.readings]


def permitted(relation_id: str, what: str, text: str) -> bool:
    """Whether a stated reading lets an alteration pass: a factor in front of 4a and 4b."""
    return any(
        relation_id == key and what.startswith(start) and text.startswith(("3 *", "2*")) for key, start in UNSEEN
    )


def outcome(found: Finding) -> list[Any]:
    """What a reader sees of a failing relation: verdict, what is left of the difference, its size."""
    checks = found.first.checks
    return [
        found.verdict,
        *((c.label, c.malformed, c.identity and (c.identity.remainder, c.identity.largest)) for c in checks),
    ]


def corrected(found: Finding) -> str:
    """The corrected form as a formula."""
    derivation = found.first.derivation
    return derivation.shown.text if derivation.shown is not None else expression_text(derivation.result)


@pytest.mark.parametrize("relation_id", FORMED)
def test_an_alteration_of_the_printed_form_changes_the_outcome(relation_id: str) -> None:
    """What follows must no longer follow; a misprint must leave another difference; see below for the rest."""
    found = finding(relation_id)
    if found.verdict in _HOLDS or found.circle:
        no_longer_follows(found)
    elif found.verdict in {Verdict.MISPRINT, Verdict.CLAIM}:
        follows_only_when_corrected(found)
    else:
        altered = PAPER[relation_id].with_formula(0, EVALUABLE[relation_id])
        assert judge(altered, PAPER).verdict is not Verdict.CANNOT


def no_longer_follows(before: Finding) -> None:
    """Every alteration of the reading that holds changes the verdict."""
    relation = before.relation
    index = next(n for n, judged in enumerate(before.judged) if judged.holds)
    for what, text in alterations(relation.readings[index].formula):
        if not permitted(relation.id, what, text):
            assert judge(relation.with_formula(index, text), PAPER).verdict is not before.verdict, (what, text)


def follows_only_when_corrected(before: Finding) -> None:
    """The corrected form follows, an altered corrected form does not, an altered misprint differs in another way."""
    relation, right = before.relation, corrected(before)
    assert judge(relation.with_formula(0, right), PAPER).verdict in _HOLDS
    for what, text in list(alterations(Formula(right)))[-3:]:
        assert not judge(relation.with_formula(0, text), PAPER).first.holds, (what, text)
    for what, text in alterations(relation.readings[0].formula) if relation.id != "17-push" else ():
        assert outcome(judge(relation.with_formula(0, text), PAPER)) != outcome(before), (what, text)


def test_a_malformed_index_expression_says_which_index_is_wrong() -> None:
    """17-push has no value, so its factors cannot matter; its indices do."""
    relation = PAPER["17-push"]
    said = [check.malformed for check in judge(relation, PAPER).first.checks]
    assert "l 3 times" in said[0]
    other = relation.with_formula(0, "1/J*F[i,I]*F[j,J]*F[k,K]*F[l,K]*C4[I,J,K,L]")
    assert "K 3 times" in judge(other, PAPER).first.checks[0].malformed


def test_words_get_a_verdict_when_a_formula_is_entered() -> None:
    words = PAPER["T1.3"]
    assert judge(words, PAPER).verdict is Verdict.CANNOT
    entered = Relation(words.id, words.place, "eta_strain", words.says, (Reading(Formula("eta_micro*Vf**2")),))
    assert judge(entered, PAPER).verdict is not Verdict.CANNOT
