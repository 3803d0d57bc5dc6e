"""A deck read back against the keyword rules: unknown words, wrong fields, names that nothing defines."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from plyflow.errors import InputError
from plyflow.hosts.abaqus.deck import LONGEST_NUMBER
from plyflow.hosts.abaqus.keywords import ELEMENTS, INTEGER, NUMBER, RULES, WORD, Rule

LONGEST_LINE, LONGEST_NAME = 256, 80
CONSTANTS_PER_LINE = 8
_NAME = re.compile(r"[A-Z@][A-Z0-9_@-]*$")
_PATTERNS = {
    INTEGER: re.compile(r"[-+]?\d+$"),
    NUMBER: re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(E[-+]?\d+)?$"),
    WORD: re.compile(r"[-+]?[A-Z0-9_]+$"),
}


@dataclass(frozen=True)
class Problem:
    """What is wrong in which line (from 1)."""

    line: int
    what: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.what}"


@dataclass
class Keyword:
    """A keyword line with its parameters and data lines."""

    name: str
    line: int
    parameters: dict[str, str | None]
    data: list[tuple[int, list[str]]] = field(default_factory=list)


def require_valid(text: str, what: str) -> None:
    """Raise for the first problem of a deck.

    Raises
    ------
    InputError
        Names the line and what is wrong with it.
    """
    for problem in problems(text):
        raise InputError(f"{what}, {problem}")


def problems(text: str) -> Iterator[Problem]:
    """Everything in a deck that breaks a rule, in order of lines."""
    found = [*_line_problems(text)]
    keywords = list(read(text))
    found += [problem for keyword in keywords for problem in _keyword_problems(keyword)]
    found += [*_place_problems(keywords), *_name_problems(keywords), *_number_problems(keywords)]
    yield from sorted(found, key=lambda problem: problem.line)


def read(text: str) -> Iterator[Keyword]:
    """Keywords of a deck with their data; comments left out, a trailing comma continues a keyword's data line."""
    current: Keyword | None = None
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*"):
            if current:
                yield current
            name, *rest = (part.strip() for part in line[1:].split(","))
            parameters = {}
            for part in rest:
                key, sign, value = (piece.strip() for piece in part.partition("="))
                parameters[key.upper()] = value.upper() if sign else None
            current = Keyword(name.upper(), number, parameters)
        elif current:
            current.data.append((number, [part.strip() for part in line.split(",")]))
        else:
            current = Keyword("", number, {})
    if current:
        yield current


def _line_problems(text: str) -> Iterator[Problem]:
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > LONGEST_LINE:
            yield Problem(number, f"{len(line)} characters, a line has at most {LONGEST_LINE}")
        if not line.isascii():
            yield Problem(number, "a character that is not ASCII")
        if not line.strip():
            yield Problem(number, "an empty line")


def _keyword_problems(keyword: Keyword) -> Iterator[Problem]:
    rule = RULES.get(keyword.name)
    if rule is None:
        yield Problem(keyword.line, f"*{keyword.name} is no keyword in use; known are {', '.join(sorted(RULES))}")
        return
    for name, value in keyword.parameters.items():
        if name not in rule.parameters:
            yield Problem(keyword.line, f"*{keyword.name} has no parameter {name}")
            continue
        allowed = rule.parameters[name]
        if allowed is None and value is not None:
            yield Problem(keyword.line, f"*{keyword.name}, {name} takes no value")
        elif allowed is not None and not value:
            yield Problem(keyword.line, f"*{keyword.name}, {name} needs a value")
        elif allowed and value not in allowed:
            yield Problem(keyword.line, f"*{keyword.name}, {name}={value}: use one of {', '.join(allowed)}")
    for name in rule.required:
        if name not in keyword.parameters:
            yield Problem(keyword.line, f"*{keyword.name} needs the parameter {name}")
    yield from _data_problems(keyword, rule)


def _data_problems(keyword: Keyword, rule: Rule) -> Iterator[Problem]:
    lines = rule.lines
    if not lines.fewest <= len(keyword.data) <= lines.most:
        yield Problem(
            keyword.line, f"*{keyword.name} has {len(keyword.data)} data lines, {lines.fewest} or more are due"
        )
    for number, fields in keyword.data:
        filled = fields[:-1] if fields and not fields[-1] else fields
        if not lines.least <= len(filled) <= lines.widest:
            yield Problem(
                number, f"{len(filled)} fields in a line of *{keyword.name}; {lines.least} to {lines.widest} are due"
            )
        for place, value in enumerate(filled):
            kind = lines.kinds[min(place, len(lines.kinds) - 1)]
            pattern = _PATTERNS.get(kind)
            if pattern and value and not pattern.match(value.upper()):
                yield Problem(number, f"'{value}' in a line of *{keyword.name} is no {kind}")
            if kind == NUMBER and len(value) > LONGEST_NUMBER:
                yield Problem(number, f"'{value}' has {len(value)} characters, a number at most {LONGEST_NUMBER}")


def _place_problems(keywords: list[Keyword]) -> Iterator[Problem]:
    inside, last = "model", ""
    for keyword in keywords:
        rule = RULES.get(keyword.name)
        if rule is None:
            continue
        if rule.inside not in (inside, "both"):
            yield Problem(keyword.line, f"*{keyword.name} belongs into the {rule.inside}, here is the {inside}")
        if rule.follows and last not in rule.follows:
            yield Problem(keyword.line, f"*{keyword.name} has to follow *{' or *'.join(rule.follows)}, not *{last}")
        inside = {"STEP": "step", "END STEP": "model"}.get(keyword.name, inside)
        last = keyword.name
    if inside == "step":
        yield Problem(keywords[-1].line, "the last *STEP has no *END STEP")


def _name_problems(keywords: list[Keyword]) -> Iterator[Problem]:
    defined: dict[str, set[str]] = {}
    for keyword in keywords:
        rule = RULES.get(keyword.name)
        for parameter, kind in (rule.defines if rule else {}).items():
            name = keyword.parameters.get(parameter)
            if name is None:
                continue
            if not _NAME.match(name) or len(name) > LONGEST_NAME:
                yield Problem(
                    keyword.line, f"the name '{name}' has to begin with a letter and be at most {LONGEST_NAME} long"
                )
            defined.setdefault(kind, set()).add(name)
        for parameter, kind in (rule.uses if rule else {}).items():
            name = keyword.parameters.get(parameter)
            if name is not None and name not in defined.get(kind, set()):
                yield Problem(keyword.line, f"the {kind} '{name}' is not defined above")
        yield from _used_in_data(keyword, defined)


def _used_in_data(keyword: Keyword, defined: dict[str, set[str]]) -> Iterator[Problem]:
    kinds = {
        "BOUNDARY": ("nset",),
        "INITIAL CONDITIONS": ("nset",),
        "DLOAD": ("elset",),
        "CONTACT PAIR": ("surface", "surface"),
        "SURFACE": ("elset",),
    }
    for number, fields in keyword.data:
        for name, kind in zip(fields, kinds.get(keyword.name, ()), strict=False):
            if not name.isdigit() and name.upper() not in defined.get(kind, set()):
                yield Problem(number, f"the {kind} '{name}' is not defined above")


def _number_problems(keywords: list[Keyword]) -> Iterator[Problem]:
    """Counts that have to agree: constants, nodes of elements, terms of equations, pairs of amplitudes."""
    nodes = {fields[0] for keyword in keywords if keyword.name == "NODE" for _, fields in keyword.data}
    for keyword in keywords:
        if keyword.name == "USER MATERIAL":
            given = sum(len([value for value in fields if value]) for _, fields in keyword.data)
            if str(given) != keyword.parameters.get("CONSTANTS"):
                yield Problem(keyword.line, f"CONSTANTS={keyword.parameters.get('CONSTANTS')}, but {given} are given")
        elif keyword.name == "ELEMENT":
            yield from _element_problems(keyword, nodes)
        elif keyword.name == "AMPLITUDE":
            yield from _amplitude_problems(keyword)
        elif keyword.name == "DEPVAR":
            count = int(keyword.data[0][1][0]) if keyword.data else 0
            for number, fields in keyword.data[1:]:
                if not 1 <= int(fields[0]) <= count:
                    yield Problem(number, f"state variable {fields[0]} of {count}")


def _element_problems(keyword: Keyword, nodes: set[str]) -> Iterator[Problem]:
    wanted = ELEMENTS.get(keyword.parameters.get("TYPE") or "", 0)
    numbers: list[str] = []
    for number, fields in keyword.data:
        numbers += [value for value in fields if value]
        if not fields[-1]:
            continue
        if len(numbers) != wanted + 1:
            yield Problem(number, f"element {numbers[0]} has {len(numbers) - 1} nodes, its type {wanted}")
        for node in numbers[1:]:
            if node not in nodes:
                yield Problem(number, f"node {node} of element {numbers[0]} is not defined")
        numbers = []


def _amplitude_problems(keyword: Keyword) -> Iterator[Problem]:
    values = [(number, value) for number, fields in keyword.data for value in fields if value]
    if len(values) % 2:
        yield Problem(keyword.line, f"{len(values)} numbers in *AMPLITUDE: time and value come in pairs")
    times = [(number, float(value)) for number, value in values[::2]]
    for (_, before), (number, after) in itertools.pairwise(times):
        if after <= before:
            yield Problem(number, f"time {after:g} in *AMPLITUDE does not come after {before:g}")
