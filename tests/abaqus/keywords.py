"""Decks read back against the rules of Abaqus's keyword reference (2016 and later), as far as the decks use it."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

MATERIAL = "MATERIAL|USER MATERIAL|DEPVAR|ELASTIC"
# Keyword; where it stands; what it has to follow; parameters (! has to be there, ~ takes no value, = those allowed);
# kinds of the fields of a data line (Integer, Number, Word, Text, the last one repeated); fewest and most of them.
RULES = {
    row[0]: row[1:]
    for line in f"""
HEADING; model; ; ; T; 1 16
NODE; model; ; NSET; I N; 3 4
ELEMENT; model; ; TYPE!=C3D8|C3D8R|C3D8H|CPE4|CAX4, ELSET; I; 1 16
NSET; model; ; NSET!; W; 1 16
SURFACE; model; ; NAME!, TYPE=ELEMENT|NODE; W; 2 2
ORIENTATION; model; ; NAME!, SYSTEM=RECTANGULAR|CYLINDRICAL; N; 2 6
MATERIAL; model; ; NAME!; T; 0 0
ELASTIC; model; {MATERIAL}; ; N; 2 3
USER MATERIAL; model; {MATERIAL}; CONSTANTS!, TYPE=MECHANICAL, UNSYMM~, HYBRID FORMULATION=INCREMENTAL|TOTAL; N; 1 8
DEPVAR; model; {MATERIAL}; ; I W T; 1 3
SOLID SECTION; model; ; ELSET!, MATERIAL!, ORIENTATION; N; 0 0
HOURGLASS STIFFNESS; model; SOLID SECTION; ; N; 1 4
AMPLITUDE; model; ; NAME!, TIME=STEP TIME|TOTAL TIME; N; 1 8
SURFACE INTERACTION; model; ; NAME!; T; 0 0
SURFACE BEHAVIOR; model; SURFACE INTERACTION; PRESSURE-OVERCLOSURE=HARD|LINEAR|EXPONENTIAL; N; 0 2
FRICTION; model; SURFACE BEHAVIOR; ; N; 1 2
CONTACT PAIR; model; ; INTERACTION!, TYPE=NODE TO SURFACE|SURFACE TO SURFACE; W; 2 2
BOUNDARY; both; ; AMPLITUDE; W I I N; 2 4
INITIAL CONDITIONS; model; ; TYPE!=TEMPERATURE; W N; 2 2
STEP; model; ; NAME, NLGEOM=YES|NO, INC, UNSYMM=YES|NO, EXTRAPOLATION=LINEAR|PARABOLIC|NO; T; 0 0
STATIC; step; ; DIRECT~; N; 2 4
CONTROLS; step; ; PARAMETERS!=FIELD|TIME INCREMENTATION, FIELD=DISPLACEMENT; N; 1 8
DLOAD; step; ; AMPLITUDE; W W N; 3 3
OUTPUT; step; ; FIELD~, HISTORY~, FREQUENCY; T; 0 0
NODE OUTPUT; step; OUTPUT; NSET; W; 1 16
ELEMENT OUTPUT; step; OUTPUT|NODE OUTPUT; ELSET; W; 1 16
NODE PRINT; step; ; NSET, TOTALS=YES|NO; W; 1 16
EL PRINT; step; ; ELSET; W; 1 16
END STEP; step; ; ; T; 0 0
""".strip().splitlines()
    for row in [[part.strip() for part in line.split(";")]]
}
KINDS = {"I": r"[-+]?\d+", "N": r"[-+]?(\d+\.?\d*|\.\d+)(E[-+]?\d+)?", "W": r"[-+]?[A-Z0-9_]+", "T": ".*"}
NODES = {"C3D8": 8, "C3D8R": 8, "C3D8H": 8, "CPE4": 4, "CAX4": 4}
DEFINES = {"NODE": "NSET", "NSET": "NSET", "ELEMENT": "ELSET"} | dict.fromkeys(
    ("SURFACE", "ORIENTATION", "MATERIAL", "AMPLITUDE", "SURFACE INTERACTION"), "NAME"
)
USED_IN_DATA = {"BOUNDARY": "NSET", "INITIAL CONDITIONS": "NSET", "DLOAD": "ELSET", "CONTACT PAIR": "SURFACE"}


@dataclass
class Keyword:
    """A keyword line with its parameters and data lines."""

    name: str
    parameters: dict[str, str | None]
    data: list[list[str]] = field(default_factory=list)

    @property
    def values(self) -> list[str]:
        """All fields of the data lines that are filled."""
        return [value for fields in self.data for value in fields if value]


def read(text: str) -> list[Keyword]:
    """Keywords of a deck with their data; comments left out."""
    found: list[Keyword] = []
    for line in (line.strip() for line in text.upper().splitlines() if not line.startswith("**")):
        parts = [part.strip() for part in line.split(",")]
        if line.startswith("*"):
            pairs = (part.partition("=") for part in parts[1:])
            found.append(Keyword(parts[0][1:], {key: value if sign else None for key, sign, value in pairs}))
        else:
            found[-1].data.append(parts)
    return found


def problems(text: str) -> list[str]:
    """Everything in a deck that breaks a rule."""
    keywords = read(text)
    lines = [line for line in text.splitlines() if not line.strip() or len(line) > 256 or not line.isascii()]
    found = [f"an empty, long or not ASCII line '{line}'" for line in lines]
    unknown = [keyword.name for keyword in keywords if keyword.name not in RULES]
    known = [keyword for keyword in keywords if keyword.name in RULES]
    found += [f"*{name} is no keyword in use" for name in unknown]
    found += [problem for keyword in known for check in (_parameters, _fields, _counts) for problem in check(keyword)]
    return [*found, *_places(known), *_names(known), *_nodes(known)]


def _parameters(keyword: Keyword) -> Iterator[str]:
    rules = dict(re.findall(r"([^!=~,]+)([^,]*)(?:, |$)", RULES[keyword.name][2]))
    for name, value in keyword.parameters.items():
        if name not in rules:
            yield f"*{keyword.name} has no parameter {name}"
        elif (rules[name] == "~") != (value is None):
            yield f"*{keyword.name}, {name} takes {'no' if rules[name] == '~' else 'a'} value"
        elif "=" in rules[name] and value not in rules[name].partition("=")[2].split("|"):
            yield f"*{keyword.name}, {name}={value} is not one of {rules[name]}"
    for name, rule in rules.items():
        if rule.startswith("!") and name not in keyword.parameters:
            yield f"*{keyword.name} needs the parameter {name}"


def _fields(keyword: Keyword) -> Iterator[str]:
    kinds, (least, most) = RULES[keyword.name][3].split(), map(int, RULES[keyword.name][4].split())
    if bool(keyword.data) != (most > 0):
        yield f"*{keyword.name} has {len(keyword.data)} data lines"
    for fields in keyword.data:
        filled = fields[:-1] if not fields[-1] else fields
        if not least <= len(filled) <= most:
            yield f"{len(filled)} fields in a line of *{keyword.name}"
        for place, value in enumerate(filled):
            kind = kinds[min(place, len(kinds) - 1)]
            if value and not re.fullmatch(KINDS[kind], value):
                yield f"'{value}' in a line of *{keyword.name} is no {kind}"
            if kind == "N" and len(value) > 20:
                yield f"'{value}' has {len(value)} characters, a number at most 20"


def _places(keywords: list[Keyword]) -> Iterator[str]:
    inside, last = "model", ""
    for keyword in keywords:
        where, follows = RULES[keyword.name][:2]
        if where not in (inside, "both"):
            yield f"*{keyword.name} belongs into the {where}, here is the {inside}"
        if follows and last not in follows.split("|"):
            yield f"*{keyword.name} has to follow *{follows}, not *{last}"
        inside = {"STEP": "step", "END STEP": "model"}.get(keyword.name, inside)
        last = keyword.name
    if inside == "step":
        yield "the last *STEP has no *END STEP"


def _names(keywords: list[Keyword]) -> Iterator[str]:
    defined: set[tuple[str, str | None]] = set()
    for keyword in keywords:
        own = DEFINES.get(keyword.name, "")
        kind = "INTERACTION" if keyword.name == "SURFACE INTERACTION" else keyword.name if own == "NAME" else own
        if own:
            defined.add((kind, keyword.parameters.get(own)))
        used = [(key, value) for key, value in keyword.parameters.items() if key in DEFINES or key in ("ELSET", "INTERACTION")]
        used += [(kind, name) for kind in (USED_IN_DATA.get(keyword.name),) if kind for name in _places_in_data(keyword)]
        yield from (f"the {key.lower()} '{value}' is not defined above" for key, value in used if (key, value) not in defined)


def _places_in_data(keyword: Keyword) -> list[str]:
    width = 2 if keyword.name == "CONTACT PAIR" else 1
    return [name for fields in keyword.data for name in fields[:width] if not name.isdigit()]


def _counts(keyword: Keyword) -> Iterator[str]:
    """Counts that have to agree: constants, numbers of state variables, pairs and times of amplitudes."""
    given = len(keyword.values)
    if keyword.name == "USER MATERIAL" and str(given) != keyword.parameters.get("CONSTANTS"):
        yield f"CONSTANTS={keyword.parameters.get('CONSTANTS')}, but {given} are given"
    if keyword.name == "DEPVAR":
        count = int(keyword.data[0][0])
        yield from (f"state variable {row[0]} of {count}" for row in keyword.data[1:] if not 1 <= int(row[0]) <= count)
    if keyword.name == "AMPLITUDE":
        times = [float(value) for value in keyword.values[::2]]
        if given % 2 or any(after <= before for before, after in itertools.pairwise(times)):
            yield f"{given} numbers in *AMPLITUDE, or a time that does not come after the one before"


def _nodes(keywords: list[Keyword]) -> Iterator[str]:
    nodes = {fields[0] for keyword in keywords if keyword.name == "NODE" for fields in keyword.data}
    for keyword in (keyword for keyword in keywords if keyword.name == "ELEMENT"):
        wanted = NODES.get(keyword.parameters.get("TYPE") or "", 0)
        for number, *own in keyword.data:
            if len(own) != wanted:
                yield f"element {number} has {len(own)} nodes, its type {wanted}"
            yield from (f"node {node} of element {number} is not defined" for node in own if node not in nodes)
