"""Imports run one way: in the generator, in the audit beside it, and between and inside the rooms of plyflow."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterable, Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {"umatgen": ROOT / "codegen", "umataudit": ROOT / "codegen", "plyflow": ROOT / "python"}
TESTS = ROOT / "tests"
# Each room with those it may import; a room may always import itself.
GENERATOR = {
    "notation": set(),
    "nodes": {"notation"},
    "model": {"notation"},
    "scene": {"notation", "model"},
    "lower": {"notation", "model", "scene", "nodes"},
    "fortran": {"notation", "model", "lower", "scene", "nodes"},
    "explain": {"notation", "model", "lower", "scene", "nodes", "fortran"},
    "pipeline": {"notation", "model", "lower", "scene", "nodes", "fortran"},
}  # fmt: skip
FROM_GENERATOR = {"umataudit": {"notation", "model"}, "plyflow": {"pipeline", "scene", "explain"}}
GROUND = {"errors", "wording", "files", "provenance"}
ORDER = (
    "law", "driver", "case", "umat", "show", "diagnose", "run", "hosts", "sweep", "audit", "paper", "evidence", "identify",
    "cli",
)  # fmt: skip


@functools.cache
def modules() -> dict[str, Path]:
    """Every module of the three packages by dotted name."""
    found = {}
    for package, folder in SOURCES.items():
        for path in (folder / package).rglob("*.py"):
            name = ".".join(path.relative_to(folder).with_suffix("").parts)
            found[name.removesuffix(".__init__")] = path
    return found


def imported(path: Path) -> set[str]:
    """Dotted names of all modules a file imports, wherever the statement stands."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def arrows() -> dict[str, set[str]]:
    """Modules of the house that each of its modules imports."""
    known = modules()
    return {name: {n for n in imported(path) if n in known and n != name} for name, path in known.items()}


def room(module: str) -> str:
    """Room of a module: the folder or file right below its package."""
    return module.split(".")[1] if "." in module else ""


def circles(graph: Mapping[str, Iterable[str]]) -> list[list[str]]:
    """Strongly connected sets of more than one node (Tarjan)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in index:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == index[node]:
            place = stack.index(node)
            if len(stack) - place > 1:
                found.append(sorted(stack[place:]))
            del stack[place:]

    for node in graph:
        if node not in index:
            visit(node)
    return found


def folders(graph: Mapping[str, Iterable[str]]) -> dict[str, set[str]]:
    """The arrows between folders; a file right below its package is a room of its own."""
    result: dict[str, set[str]] = {}
    for name, others in graph.items():
        result.setdefault(_place(name), set()).update(_place(other) for other in others)
    return {place: {o for o in others if o != place} for place, others in result.items()}


def _place(module: str) -> str:
    path = modules()[module]
    return path.parent.as_posix() if len(module.split(".")) > 2 or path.name == "__init__.py" else module


def generator_faults(module: str, names: Iterable[str]) -> set[str]:
    """Rooms of umatgen that a module of umatgen must not import."""
    used = {room(n) for n in names if n.startswith("umatgen.")} & set(GENERATOR)
    return used - GENERATOR.get(room(module), set()) - {room(module)}


def room_faults(module: str, names: Iterable[str]) -> set[str]:
    """Rooms of plyflow that a module of plyflow must not import."""
    used = {room(n) for n in names if n.startswith("plyflow.")} - {"", "driver_library", room(module)}
    if room(module) in GROUND:
        return used - GROUND
    place = ORDER.index(room(module)) if room(module) in ORDER else len(ORDER)
    return used - GROUND - set(ORDER[:place])


def test_no_stage_of_the_generator_imports_a_later_one() -> None:
    for name, names in arrows().items():
        if name.startswith("umatgen."):
            assert generator_faults(name, names) == set(), name


def test_the_rooms_of_plyflow_import_one_way() -> None:
    for name, names in arrows().items():
        if name.startswith("plyflow."):
            assert room_faults(name, names) == set(), name


def test_no_circle_of_files_nor_of_folders() -> None:
    graph = arrows()
    assert circles(graph) == []
    assert circles(folders(graph)) == []


def test_planted_arrows_are_seen() -> None:
    assert generator_faults("umatgen.model.lock", {"umatgen.fortran.printer"}) == {"fortran"}
    assert room_faults("plyflow.law.equations", {"plyflow.case.case"}) == {"case"}
    assert room_faults("plyflow.files", {"plyflow.cli.run"}) == {"cli"}
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]


def test_the_generator_never_imports_plyflow_nor_runs_a_program() -> None:
    for name, path in modules().items():
        if name.startswith("uma"):
            assert not {n.split(".")[0] for n in imported(path)} & {"plyflow", "subprocess", "ctypes", "os"}, path


def test_others_use_only_the_public_rooms_of_the_generator() -> None:
    for name, path in modules().items():
        used = {room(n) for n in imported(path) if n.startswith("umatgen.")} & set(GENERATOR)
        beside = FROM_GENERATOR["umataudit"] if name.startswith("plyflow.audit") else set()  # what the audit reads
        assert used <= FROM_GENERATOR.get(name.split(".")[0], used) | beside, path


def test_the_oracle_shares_no_code_with_umatgen() -> None:
    for path in (TESTS / "oracle").rglob("*.py"):
        assert not any(name.split(".")[0] == "umatgen" for name in imported(path)), path
