"""Printed formulas as data: what they evaluate to, what they refuse, units, LaTeX and MathML."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest
import sympy as sp
from markupsafe import Markup

from umataudit.printed import PAPER, Book, Formula, FormulaError
from umataudit.printed.letters import LETTERS, sym, tensor
from umataudit.printed.tensors import IndexNotationError
from umataudit.printed.units import CONSISTENT, check_units
from umataudit.render import expression_text, latex, mathml, plain, typeset
from umatgen.notation import TABLE

TEXTS = sorted({reading.formula.text for relation in PAPER.values() for reading in relation.readings})


def test_decimal_numbers_are_exact() -> None:
    assert Formula("0.1 + 0.2").value == sp.Rational(3, 10)


def test_factors_and_terms_keep_the_printed_order() -> None:
    k, chi_f = sym("k chi_f")
    assert Formula("2*sqrt(chi_f)*(k + 1)").factors() == [2, sp.sqrt(chi_f), k + 1]
    assert Formula("k - chi_f/2 + 1").terms() == [k, -chi_f / 2, 1]


def test_repeated_indices_are_summed() -> None:
    J, f = sym("J")[0], tensor("F")
    pushed = Formula("1/J*F[i,I]*F[j,J]*delta[k,I]*delta[l,J]").value
    assert sp.expand(pushed[0, 1, 2, 0] - f[0, 2] * f[1, 0] / J) == 0
    trace = Formula("F[k,K]*F[l,K]*delta[i,j]").value
    assert sp.expand(trace[1, 1, 0, 2] - sum(f[0, n] * f[2, n] for n in range(3))) == 0


@pytest.mark.parametrize(
    "text", ["F[i,l]*F[j,l]*F[k,K]*F[l,L]*C4[I,J,K,L]", "F[i,j]*F[k,K]", "F[i,j]*F[k,l]*F[I,I]*F[I,K]"]
)
def test_an_index_that_occurs_wrongly_is_refused(text: str) -> None:
    with pytest.raises(IndexNotationError, match="times"):
        Formula(text).value  # noqa: B018


@pytest.mark.parametrize("text", ["wrong_letter + 1", "cosh(k)", "k if 1 else 2"])
def test_an_unknown_name_or_construction_is_refused(text: str) -> None:
    with pytest.raises(FormulaError):
        Formula(text).value  # noqa: B018


def test_an_id_used_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="registered twice"):
        Book([PAPER["1"], PAPER["1"]])


UNITS = {
    "sigma": ("eta_micro*eta_ply*eps_dot", "eta_micro*eta_ply"),
    "eps": ("ln(h/h0)", "ln(h)"),
    "b": ("ln(eta_res) + b_bar", "b_bar*ln(eta_res)"),
    "alpha_f": ("arctan(d**2/(4*Af))", "arctan(d/(4*Af))"),
    "k": ("d/a_y", "d + 1"),
    "J2": ("Cdot11**2/2", "C11**2"),
}


@pytest.mark.parametrize("left", UNITS)
def test_units_that_fit_pass_and_others_do_not(left: str) -> None:
    fitting, failing = (check_units(left, Formula(text).tree) for text in UNITS[left])
    assert fitting == CONSISTENT
    assert failing not in {CONSISTENT, ""}


@pytest.mark.parametrize("text", TEXTS)
def test_every_formula_is_well_formed_mathml(text: str) -> None:
    root = ET.fromstring(f"<all>{mathml('', text).replace('<wbr>', '')}</all>")
    assert {element.tag for element in root} == {"math"}
    leaves = [element for element in root.iter() if element.tag in {"mi", "mn", "mfrac", "msup"}]
    assert all(element.text or len(element) for element in leaves)
    assert "\\" not in "".join(root.itertext())


LATEX = {
    "-4*eps": r"-4 \, \varepsilon",
    "(k - 1)**2": r"{\left(k - 1\right)}^{2}",
    "k - (h0 - 1)": r"k - \left(h_0 - 1\right)",
    "k - -h0": r"k - \left(-h_0\right)",
    "-(k + 1)*h0 + -k": r"-\left(k + 1\right) \, h_0 - k",
    "-k/h0*d": r"-\frac{k}{h_0} \, d",
    "(1/I1s)**(-3/2)": r"{\left(\frac{1}{I_1^s}\right)}^{-\frac{3}{2}}",
    "2*2**(1/n)": r"2 \cdot {2}^{\frac{1}{n}}",
    "2*k": r"2 \, k",
}
"""Signs, brackets and powers are kept; a number after a factor has a dot before it."""


@pytest.mark.parametrize("text", LATEX)
def test_the_arrangement_of_a_formula_is_kept(text: str) -> None:
    assert latex(text) == LATEX[text]


def test_a_component_of_a_gradient_keeps_its_letters_apart() -> None:
    shown = Markup(mathml("", "Pe_12")).striptags()
    assert "\u2202" in shown
    assert "partial" not in shown


PROSE = {
    "at $eps = -0.07$ (squeezing)": "at \u03b5=\u22120.07 (squeezing)",
    "$psi_v >= 0$, `a_b`": "\u03c8v\u22650, a_b",
    "$S_e : Cdot/2 = dpsi_e/dC : Cdot$": "Se:C\u02d92=\u2202\u03c8e\u2202C:C\u02d9",
    "<b> & $X$": "&lt;b&gt; &amp; X",
}
"""What stands between dollar signs is set, and nothing else."""


@pytest.mark.parametrize("prose", PROSE)
def test_formulas_in_prose_are_set(prose: str) -> None:
    shown = typeset(prose)
    assert Markup.escape(shown.striptags()) == Markup(PROSE[prose])
    assert shown.count("<math>") >= prose.count("$") // 2
    assert "$" not in plain(prose)


def test_what_is_no_formula_is_refused_between_dollar_signs() -> None:
    with pytest.raises((ValueError, SyntaxError)):
        typeset("$(shear rate)(k)$")


def test_a_wide_formula_is_set_in_pieces_that_make_up_the_whole() -> None:
    text = PAPER["13"].readings[0].formula.text
    pieces = mathml("psi_v", text).split("<wbr>")
    assert len(pieces) > 4
    assert all(piece.count("<math>") == piece.count("</math>") == 1 for piece in pieces)
    whole = mathml("", "k + 1").split("<wbr>")
    assert len(whole) == 1
    brackets = Markup("".join(mathml("", PAPER["10"].readings[0].formula.text))).striptags()
    assert brackets.count("(") == brackets.count(")") == PAPER["10"].readings[0].formula.text.count("(") - 1


def test_text_of_an_expression_reads_back() -> None:
    value = Formula("(w0/h0)**2*exp(-2*(eps + eps_l))/(a + 2)*ln(J) - arcsin(k)*maximum(C11, I1b)").value
    assert sp.simplify(Formula(expression_text(value)).value - value) == 0


def test_letters_that_the_model_has_are_its_symbols() -> None:
    assert LETTERS["J"].symbol == TABLE.symbol("det_f")
    assert LETTERS["I1s"].symbol == TABLE.symbol("x_end")
