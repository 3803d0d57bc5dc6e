"""The worked example of docs/audit-howto.md runs as it stands."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

HOWTO = Path(__file__).resolve().parents[2] / "docs" / "audit-howto.md"


def run_blocks(change: tuple[str, str] = ("", "")) -> subprocess.CompletedProcess[str]:
    """Run all Python blocks of the page as one script, with one text replaced."""
    blocks = re.findall(r"```python\n(.*?)```", HOWTO.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len(blocks) == 6
    script = "\n".join(blocks)
    assert not change[0] or change[0] in script
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        [sys.executable, "-c", script.replace(*change) if change[0] else script],
        env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_the_worked_example_runs() -> None:
    run = run_blocks()
    assert run.returncode == 0, run.stderr
    assert "Verdict.MISPRINT" in run.stdout
    assert "squeeze" in run.stdout


def test_a_slip_in_the_emitted_factor_of_the_example_is_noticed() -> None:
    run = run_blocks(("paper_factor(stage) * (k / gap) ** 2 /", "2 * paper_factor(stage) * (k / gap) ** 2 /"))
    assert run.returncode != 0
    assert "AssertionError" in run.stderr
