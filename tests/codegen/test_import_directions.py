"""Imports run one way: notation, printed <- model <- lower <- fortran <- pipeline; plyflow uses pipeline and audit only."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
UMATGEN, PLYFLOW, TESTS = ROOT / "codegen" / "umatgen", ROOT / "python" / "plyflow", ROOT / "tests"
ALLOWED = {
    "notation": set(),
    "printed": {"notation"},
    "model": {"notation", "printed"},
    "scene": {"model"},
    "lower": {"notation", "model"},
    "fortran": {"notation", "model", "lower", "scene"},
    "audit": {"notation", "printed", "model"},
    "pipeline": {"fortran", "lower", "scene"},
}
PUBLIC = {"pipeline", "scene", "audit", "printed"}


def imported(path: Path) -> set[str]:
    """Dotted names of all modules a file imports."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def stage_faults(part: str, names: set[str]) -> set[str]:
    """Stages of umatgen that a stage must not import."""
    used = {name.split(".")[1] for name in names if name.startswith("umatgen.")}
    stages = used & set(ALLOWED)
    return stages - ALLOWED[part] - {part}


def test_no_stage_imports_a_later_one() -> None:
    for part in ALLOWED:
        files = [UMATGEN / f"{part}.py"] if (UMATGEN / f"{part}.py").is_file() else (UMATGEN / part).rglob("*.py")
        for path in files:
            assert stage_faults(part, imported(path)) == set(), path


def test_a_planted_backward_import_is_seen() -> None:
    assert stage_faults("model", {"umatgen.fortran.printer"}) == {"fortran"}


def test_umatgen_never_imports_plyflow_nor_runs_a_program() -> None:
    for path in UMATGEN.rglob("*.py"):
        names = {name.split(".")[0] for name in imported(path)}
        assert not names & {"plyflow", "subprocess", "ctypes", "os"}, path


def test_plyflow_uses_only_the_public_stages() -> None:
    for path in PLYFLOW.rglob("*.py"):
        used = {n.split(".")[1] for n in imported(path) if n.startswith("umatgen.")} & set(ALLOWED)
        assert used <= PUBLIC, path


def test_the_oracle_shares_no_code_with_umatgen() -> None:
    for path in (TESTS / "oracle").rglob("*.py"):
        assert not any(name.split(".")[0] == "umatgen" for name in imported(path)), path
