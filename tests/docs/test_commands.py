"""Every shell command that README, examples and site show is run, in the order of its page; none is left out silently."""

from __future__ import annotations

from pathlib import Path

import pytest

from docs.shown import CHEAP, ELSEWHERE, NOT_RUN, PAGES, ROOT, blocks, run, runnable, with_examples

NAMES = {str(page.relative_to(ROOT)): blocks(page.read_text(encoding="utf-8")) for page in PAGES}
TO_RUN = [name for name, found in NAMES.items() if found and name not in ELSEWHERE]


def script(name: str) -> str:
    """All blocks of a page as one script; a block that changes the folder does so for itself."""
    used: set[str] = set()
    return "\n".join("(\n" + "\n".join(runnable(line, used) for line in one.splitlines()) + "\n:)" for one in NAMES[name])


@pytest.mark.parametrize("name", TO_RUN)
def test_the_commands_of_a_page_run(name: str, tmp_path: Path) -> None:
    done = run(script(name), with_examples(tmp_path))
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr}"


def test_a_wrong_option_on_a_page_would_fail(tmp_path: Path) -> None:
    assert "plyflow law1d" in script("docs/start-process.md")
    done = run("plyflow law1d --matrial material.toml\necho on", tmp_path)
    assert done.returncode == 2 and "on" not in done.stdout.split()


def test_each_exception_is_needed_and_has_its_reason() -> None:
    used: set[str] = set()
    for found in NAMES.values():
        for block in found:
            for line in block.splitlines():
                runnable(line, used)
    assert used == {*NOT_RUN, *(wanted for wanted, _, _ in CHEAP)}
    assert all(NOT_RUN.values()) and all(reason for _, _, reason in CHEAP)
    assert set(ELSEWHERE) <= set(NAMES) and all((ROOT / test).is_file() for test in ELSEWHERE.values())
