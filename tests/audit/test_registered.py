"""Derived = registered: the model's expressions equal the audited forms, and a changed model is noticed."""

from __future__ import annotations

from collections.abc import Callable

import pytest
import sympy as sp
from alterations import finding

from plyflow.audit.report import Audit
from umataudit.registered import registered
from umatgen.model import elastic, generators, law_1d, viscous
from umatgen.notation import sym as model_sym

LINKED = ["3", "4a", "4b", "5a", "5b", "5-chi_l", "8", "9", "10", "13", "13-I1s", "14", "15", "15-f", "16", "17-C'", "T4.G23"]


@pytest.mark.parametrize("relation_id", LINKED)
def test_the_model_expression_is_the_audited_form(relation_id: str) -> None:
    links = registered(finding(relation_id))
    assert links
    assert all(link.identity.holds for link in links), [link.name for link in links if not link.identity.holds]


def doubled(function: Callable[..., sp.Expr]) -> Callable[..., sp.Expr]:
    """The same expression times 2."""
    return lambda *arguments: 2 * function(*arguments)


@pytest.mark.parametrize(
    ("relation_id", "module", "name"),
    [
        ("4a", law_1d, "eta_ply"),
        ("5b", law_1d, "eta_micro"),
        ("3", law_1d, "compressive_stress"),
        ("13", viscous, "factor_f"),
        ("14", viscous, "factor_f"),
        ("10", elastic, "potential"),
    ],
)
def test_a_factor_in_the_model_is_noticed(
    relation_id: str, module: object, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, name, doubled(getattr(module, name)))
    assert not all(link.identity.holds for link in registered(finding(relation_id)))


def test_a_wrong_gradient_rule_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    rules = generators.gradient_rules()
    (a23,) = model_sym("a23")
    rules[a23] = {generators.M23: sp.S.One}
    monkeypatch.setattr("umataudit.registered.gradient_rules", lambda: rules)
    wrong = [link.name for link in registered(finding("9")) if not link.identity.holds]
    assert wrong == ["generators: da23/dC"]


def test_the_chain_of_each_equation_reaches_the_compiled_code(audited: Audit) -> None:
    rows = {row.id: row for row in audited.rows}
    for relation_id in ("4a", "4b", "5a", "5b", "8", "9", "10", "13", "14", "15", "16", "17"):
        said = " ".join(line.said for line in rows[relation_id].chain)
        assert "printed -> derived" in said
        assert "compiled" in said
        assert "agree" in said
