"""The rules of the Abaqus keywords that the decks use, as data: parameters, data lines, place in the deck.

From the keyword reference of Abaqus (2016 and later); only what is used here is listed, so that an unknown keyword or
parameter is an error.
"""

from __future__ import annotations

from dataclasses import dataclass, field

INTEGER, NUMBER, WORD, TEXT = "integer", "number", "word", "text"


@dataclass(frozen=True)
class Lines:
    """Data lines of a keyword.

    Parameters
    ----------
    kinds : kinds of the fields of a line: "integer", "number", "word" (a label or number of a node, element or set) or
        "text"; a field beyond them has the kind of the last.
    fewest, most : number of lines.
    least, widest : number of fields of a line; the last may be followed by a comma.
    """

    kinds: tuple[str, ...]
    fewest: int = 1
    most: int = 1_000_000
    least: int = 1
    widest: int = 16


NOTHING = Lines((TEXT,), 0, 0, 0, 0)


@dataclass(frozen=True)
class Rule:
    """A keyword: where it may stand, its parameters (None: a flag; empty: any value; else those allowed), data lines.

    Parameters
    ----------
    follows : keywords one of which must be the last before it; empty: any.
    inside : "model" or "step".
    required : parameters that have to be there.
    defines, uses : for a parameter the kind of name it defines or refers to.
    """

    inside: str
    lines: Lines
    parameters: dict[str, tuple[str, ...] | None] = field(default_factory=dict)
    required: tuple[str, ...] = ()
    defines: dict[str, str] = field(default_factory=dict)
    uses: dict[str, str] = field(default_factory=dict)
    follows: tuple[str, ...] = ()


ANY: tuple[str, ...] = ()
ELEMENTS = {"C3D8": 8, "C3D8R": 8, "C3D8H": 8, "C3D20": 20, "C3D20R": 20, "CPE4": 4, "CAX4": 4}
_MATERIAL = ("MATERIAL", "USER MATERIAL", "DEPVAR", "ELASTIC")

RULES: dict[str, Rule] = {
    "HEADING": Rule("model", Lines((TEXT,), 1, 100)),
    "NODE": Rule("model", Lines((INTEGER, NUMBER), least=3, widest=4), {"NSET": ANY}, defines={"NSET": "nset"}),
    "ELEMENT": Rule(
        "model",
        Lines((INTEGER,)),
        {"TYPE": tuple(ELEMENTS), "ELSET": ANY},
        ("TYPE",),
        defines={"ELSET": "elset"},
    ),
    "NSET": Rule("model", Lines((WORD,)), {"NSET": ANY, "GENERATE": None}, ("NSET",), defines={"NSET": "nset"}),
    "SURFACE": Rule(
        "model",
        Lines((WORD, WORD), least=2, widest=2),
        {"NAME": ANY, "TYPE": ("ELEMENT", "NODE")},
        ("NAME",),
        defines={"NAME": "surface"},
    ),
    "ORIENTATION": Rule(
        "model",
        Lines((NUMBER,), 1, 2, 2, 6),
        {"NAME": ANY, "SYSTEM": ("RECTANGULAR", "CYLINDRICAL")},
        ("NAME",),
        defines={"NAME": "orientation"},
    ),
    "MATERIAL": Rule("model", NOTHING, {"NAME": ANY}, ("NAME",), defines={"NAME": "material"}),
    "ELASTIC": Rule("model", Lines((NUMBER,), least=2, widest=3), follows=_MATERIAL),
    "USER MATERIAL": Rule(
        "model",
        Lines((NUMBER,), widest=8),
        {
            "CONSTANTS": ANY,
            "TYPE": ("MECHANICAL",),
            "UNSYMM": None,
            "HYBRID FORMULATION": ("INCREMENTAL", "TOTAL", "INCOMPRESSIBLE"),
        },
        ("CONSTANTS",),
        follows=_MATERIAL,
    ),
    "DEPVAR": Rule("model", Lines((INTEGER, WORD, TEXT), widest=3), follows=_MATERIAL),
    "SOLID SECTION": Rule(
        "model",
        Lines((NUMBER,), 0, 1, 0, 1),
        {"ELSET": ANY, "MATERIAL": ANY, "ORIENTATION": ANY},
        ("ELSET", "MATERIAL"),
        uses={"ELSET": "elset", "MATERIAL": "material", "ORIENTATION": "orientation"},
    ),
    "HOURGLASS STIFFNESS": Rule("model", Lines((NUMBER,), 1, 1, 1, 4), follows=("SOLID SECTION",)),
    "EQUATION": Rule("model", Lines((NUMBER,))),
    "AMPLITUDE": Rule(
        "model",
        Lines((NUMBER,), widest=8),
        {"NAME": ANY, "TIME": ("STEP TIME", "TOTAL TIME")},
        ("NAME",),
        defines={"NAME": "amplitude"},
    ),
    "SURFACE INTERACTION": Rule("model", NOTHING, {"NAME": ANY}, ("NAME",), defines={"NAME": "interaction"}),
    "SURFACE BEHAVIOR": Rule(
        "model",
        Lines((NUMBER,), 0, 100, 0, 2),
        {"PRESSURE-OVERCLOSURE": ("HARD", "LINEAR", "EXPONENTIAL")},
        follows=("SURFACE INTERACTION",),
    ),
    "FRICTION": Rule("model", Lines((NUMBER,), 1, 1, 1, 2), follows=("SURFACE BEHAVIOR", "SURFACE INTERACTION")),
    "CONTACT PAIR": Rule(
        "model",
        Lines((WORD, WORD), least=2, widest=2),
        {"INTERACTION": ANY, "TYPE": ("NODE TO SURFACE", "SURFACE TO SURFACE")},
        ("INTERACTION",),
        uses={"INTERACTION": "interaction"},
    ),
    "BOUNDARY": Rule(
        "both",
        Lines((WORD, INTEGER, INTEGER, NUMBER), least=2, widest=4),
        {"AMPLITUDE": ANY},
        uses={"AMPLITUDE": "amplitude"},
    ),
    "INITIAL CONDITIONS": Rule(
        "model", Lines((WORD, NUMBER), least=2, widest=2), {"TYPE": ("TEMPERATURE",)}, ("TYPE",)
    ),
    "STEP": Rule(
        "model",
        NOTHING,
        {
            "NAME": ANY,
            "NLGEOM": ("YES", "NO"),
            "INC": ANY,
            "UNSYMM": ("YES", "NO"),
            "EXTRAPOLATION": ("LINEAR", "PARABOLIC", "VELOCITY PARABOLIC", "NO"),
        },
    ),
    "STATIC": Rule("step", Lines((NUMBER,), 1, 1, 2, 4), {"DIRECT": None}),
    "VISCO": Rule("step", Lines((NUMBER,), 1, 1, 2, 4), {"CETOL": ANY}, ("CETOL",)),
    "CONTROLS": Rule(
        "step",
        Lines((NUMBER,), 1, 3, 1, 8),
        {"PARAMETERS": ("FIELD", "TIME INCREMENTATION"), "FIELD": ("DISPLACEMENT",)},
        ("PARAMETERS",),
    ),
    "DLOAD": Rule(
        "step", Lines((WORD, WORD, NUMBER), least=3, widest=3), {"AMPLITUDE": ANY}, uses={"AMPLITUDE": "amplitude"}
    ),
    "OUTPUT": Rule("step", NOTHING, {"FIELD": None, "HISTORY": None, "FREQUENCY": ANY}),
    "NODE OUTPUT": Rule("step", Lines((WORD,)), {"NSET": ANY}, uses={"NSET": "nset"}, follows=("OUTPUT",)),
    "ELEMENT OUTPUT": Rule(
        "step", Lines((WORD,)), {"ELSET": ANY}, uses={"ELSET": "elset"}, follows=("OUTPUT", "NODE OUTPUT")
    ),
    "NODE PRINT": Rule("step", Lines((WORD,)), {"NSET": ANY, "TOTALS": ("YES", "NO")}, uses={"NSET": "nset"}),
    "EL PRINT": Rule("step", Lines((WORD,)), {"ELSET": ANY}, uses={"ELSET": "elset"}),
    "END STEP": Rule("step", NOTHING),
}
