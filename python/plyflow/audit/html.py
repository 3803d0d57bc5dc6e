"""The audit as one HTML page: MathML, no network, readable on a phone and printable."""

from __future__ import annotations

import re
from importlib import resources

import jinja2
from markupsafe import Markup

from plyflow.audit.report import MEANT, Audit, Line
from umataudit.render import mathml

SLUGS = {
    "follows": "follows",
    "follows under a stated reading": "reading",
    "misprint": "misprint",
    "cannot be evaluated": "cannot",
}


def render_html(audit: Audit) -> str:
    """The audit as HTML text."""
    template = resources.files("plyflow") / "audit" / "template.html.j2"
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.globals |= {"equation": _equation, "with_formula": _with_formula, "slugs": SLUGS, "meant": MEANT}
    return environment.from_string(template.read_text(encoding="utf-8")).render(audit=audit)


def _equation(left: str, right: str) -> Markup:
    """An equation as one MathML element; only the right-hand side when there is no left."""
    if not left:
        return Markup(mathml(right))
    sides = (re.sub(r"^<math[^>]*>|</math>$", "", mathml(side)) for side in (left, right))
    return Markup('<math display="block"><mrow>{}<mo>=</mo>{}</mrow></math>').format(*map(Markup, sides))


def _with_formula(line: Line) -> Markup:
    """A sentence with its formula behind it."""
    formula = Markup('<span class="math">{}</span>').format(Markup(mathml(line.formula))) if line.formula else Markup()
    return Markup("{} {}").format(line.said, formula)
