"""The shell commands that README, examples and site show: found, and made runnable in an empty folder."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ENVIRONMENT = {"COLUMNS": "100", "OPENBLAS_NUM_THREADS": "1"}  # threads of small matrices cost more than they give
ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "examples" / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
# Pages whose commands another test runs and compares with what the page says they print.
ELSEWHERE = {
    "docs/tutorial.md": "tests/identify/test_tutorial.py",
    "examples/README.md": "tests/docs/test_site.py",  # the gallery of the site is this page, its pictures what it makes
}
# What is not run: expression, reason. An entry that no page needs fails the test.
NOT_RUN = {
    r"(cd \S+ && )?abaqus job=\S+ user=\S+( interactive)?": "needs Abaqus and its licence",
    r"\./run (setup|docs|test)": "installs, or would run the tests within the tests",
    r"\.venv/bin/(pytest|ruff|mypy)\b.*": "these are the tests",
    r"\.venv/bin/python umat/regenerate\.py.*": "writes committed sources anew",
}
# What is run in a cheaper form: expression, replacement, reason.
CHEAP = [
    (r"\./run demo", "plyflow demo --help > help.txt", "6 s and it installs first; tests/paper/test_demo.py runs it"),
    (r"audit --html", "audit --help | grep -e --html #", "20 s; tests/audit runs it"),
    (
        r"--grid material=IM7-8552,IMA-M21 --grid layup=BP,CP --grid width=15,30\s+--grid temperature=30:90:10 --set cells=8",
        "--grid material=IM7-8552,IMA-M21 --grid layup=BP,CP --grid width=15,30 --grid temperature=90 --set cells=1",
        "an hour; 8 cases of 56",
    ),
    (r"plyflow laminate --material IM7-8552 --temperature 70 --layup BP", r"\g<0> --cells 1", "10 s at 8 cells"),
    (r"mgis check default --full --json", "mgis check default --json", "half a minute; three blocks stand for all"),
    (r"--grid gamma_lock=75:85@5", "--grid gamma_lock=80", "a fifth of the cases"),
]


def blocks(page: str) -> list[str]:
    """The `sh` blocks of a page, continued lines joined."""
    found = re.findall(r"^ *```sh\n(.*?)^ *```$", page, flags=re.DOTALL | re.MULTILINE)
    return [re.sub(r"\\\n\s*", "", block) for block in found]


def runnable(line: str, used: set[str]) -> str:
    """A line of a block as it is run: nothing where it is not, cheaper where the table says so."""
    command = line.partition("  #")[0].strip()
    for wanted in NOT_RUN:
        if re.fullmatch(wanted, command):
            used.add(wanted)
            return ""
    for wanted, instead, _ in CHEAP:
        if re.search(wanted, line):
            used.add(wanted)
            line = re.sub(wanted, instead, line)
    return line.replace(".venv/bin/", "")


def run(script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A script in a shell that stops at the first failure, with the plyflow that is being tested in the path."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        ["/bin/sh", "-eu", "-c", script], cwd=folder, env=os.environ | ENVIRONMENT | {"PATH": path},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def with_examples(folder: Path) -> Path:
    """A folder with the files of `examples`, as the pages presume it."""
    return Path(shutil.copytree(ROOT / "examples", folder, dirs_exist_ok=True))
