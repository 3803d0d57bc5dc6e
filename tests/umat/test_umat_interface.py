"""The emitted text: UMAT's 37 arguments in Abaqus's order and types, PROPS and STATEV in the fixed order."""

import re
from typing import Any

from oracle import PROPERTY_NAMES

ARGUMENTS = [
    "STRESS", "STATEV", "DDSDDE", "SSE", "SPD", "SCD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT", "STRAN",
    "DSTRAN", "TIME", "DTIME", "TEMP", "DTEMP", "PREDEF", "DPRED", "CMNAME", "NDI", "NSHR", "NTENS",
    "NSTATV", "PROPS", "NPROPS", "COORDS", "DROT", "PNEWDT", "CELENT", "DFGRD0", "DFGRD1", "NOEL",
    "NPT", "LAYER", "KSPT", "KSTEP", "KINC",
]  # fmt: skip
INTEGERS = [
    "NDI", "NSHR", "NTENS", "NSTATV", "NPROPS", "NOEL", "NPT", "LAYER", "KSPT", "KSTEP", "KINC",
]  # fmt: skip
DIMENSIONS = {
    "STRESS": "NTENS", "STATEV": "NSTATV", "DDSDDE": "NTENS,NTENS", "DDSDDT": "NTENS", "DRPLDE": "NTENS",
    "STRAN": "NTENS", "DSTRAN": "NTENS", "TIME": "2", "PREDEF": "1", "DPRED": "1", "PROPS": "NPROPS",
    "COORDS": "3", "DROT": "3,3", "DFGRD0": "3,3", "DFGRD1": "3,3",
}  # fmt: skip
STATEV_NAMES = ("eps", "width", "J", "fibre_fraction", "locked", "pressure", "eps_rate", "dissipation")


def statements(source: str) -> list[str]:
    """Statements without comments, continuation lines joined, blanks squeezed."""
    joined: list[str] = []
    for line in source.splitlines():
        if not line.strip() or line.startswith(("!", "*", "C")):
            continue
        text = line.rstrip().removesuffix("&").strip()
        if re.match(r" {5}\S", line):
            joined[-1] += text.removeprefix("&").strip()
        else:
            joined.append(text)
    return [re.sub(r"\s+", " ", statement) for statement in joined]


def arguments_of(source: str) -> list[str]:
    """Names of the dummy arguments of UMAT."""
    head = next(s for s in statements(source) if s.upper().startswith("SUBROUTINE UMAT"))
    return [name.strip().upper() for name in head[head.index("(") + 1 : head.rindex(")")].split(",")]


def declarations(source: str) -> dict[str, tuple[str, str]]:
    """Type and dimensions of what UMAT declares."""
    body = statements(source)
    first = next(i for i, s in enumerate(body) if s.upper().startswith("SUBROUTINE UMAT"))
    declared = {}
    for statement in body[first + 1 : body.index("END SUBROUTINE UMAT")]:
        kind, colons, names = statement.partition("::")
        if colons and not kind.startswith(("ASSOCIATE", "USE")):
            for name, dimensions in re.findall(r"(\w+)(?:\(([\w, ]*)\))?(?:,|$)", names.replace(" ", "")):
                declared[name.upper()] = (kind.strip().upper(), dimensions.upper())
    return declared


def test_umat_has_the_37_arguments_of_abaqus_in_order(emitted: Any) -> None:
    assert len(ARGUMENTS) == 37
    assert arguments_of(emitted.source) == ARGUMENTS


def test_order_check_sees_two_arguments_exchanged(emitted: Any) -> None:
    assert arguments_of(emitted.source.replace("SPD, SCD,", "SCD, SPD,", 1)) != ARGUMENTS


def test_umat_declares_every_argument_with_the_type_and_shape_of_abaqus(emitted: Any) -> None:
    declared = declarations(emitted.source)
    for name in ARGUMENTS:
        kind, dimensions = declared[name]
        assert dimensions == DIMENSIONS.get(name, ""), name
        if name == "CMNAME":
            assert kind.replace(" ", "") in ("CHARACTER(LEN=80)", "CHARACTER*80")
        else:
            assert kind == ("INTEGER" if name in INTEGERS else "DOUBLE PRECISION"), name


def test_manifest_lists_props_and_statev_in_the_fixed_order(emitted: Any) -> None:
    for entries, names in ((emitted.manifest["props"], PROPERTY_NAMES), (emitted.manifest["statev"], STATEV_NAMES)):
        assert [entry["name"] for entry in entries] == list(names)
        assert [entry["index"] for entry in entries] == list(range(1, len(names) + 1))
        assert all(entry["unit"] for entry in entries)


def test_source_reads_the_props_that_the_manifest_lists(emitted: Any) -> None:
    read = {int(i) for i in re.findall(r"=\s*props\((\d+)\)", emitted.source)}
    assert read == {entry["index"] for entry in emitted.manifest["props"]}


def test_source_fits_fixed_form(emitted: Any) -> None:
    for line in emitted.source.splitlines():
        assert len(line.removesuffix("&").rstrip()) <= 72, line
        assert line.isascii()
