"""Formulas for people: plain text, LaTeX and MathML from one syntax tree, in the printed arrangement."""

from umataudit.render.expression import expression_text, value_text
from umataudit.render.latex import latex
from umataudit.render.mathml import mathml

__all__ = ["expression_text", "latex", "mathml", "value_text"]
