"""Formulas for people: plain text, LaTeX and MathML from one syntax tree, in the printed arrangement."""

from umatgen.audit.render.expression import expression_text, value_text
from umatgen.audit.render.latex import latex
from umatgen.audit.render.mathml import mathml

__all__ = ["expression_text", "latex", "mathml", "value_text"]
