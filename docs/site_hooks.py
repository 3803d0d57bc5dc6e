"""What the site makes itself: mathematics as MathML, the command reference, the gallery with its pictures, the navigation."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from html import escape, unescape
from pathlib import Path
from shutil import copytree
from typing import Any

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

from plyflow.cli import GROUPS, load

ROOT = Path(__file__).resolve().parents[1]
GALLERY = ROOT / "examples"
NEEDS_ABAQUS = re.compile(r"(cd \S+ && )?abaqus job=.*")
ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}  # threads of small matrices cost more than they give
FIGURES = "2a"
PICTURES = 1  # of a command; the first in alphabetical order


def on_config(config: Any) -> Any:
    """Put pages that the navigation does not name under "How to"."""
    named = set(re.findall(r"[\w-]+\.md", str(config["nav"])))
    others = sorted(path.name for path in (ROOT / "docs").glob("*.md") if path.name not in named)
    next(entry["How to"] for entry in config["nav"] if "How to" in entry).extend(others)
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are made."""
    reference = commands()
    text, pictures = gallery()
    made = {"commands.md": reference, "gallery.md": text, **pictures, **figures()}
    for name, content in made.items():
        files.append(File.generated(config, name, content=content))
    return files


def on_page_content(html: str, **_: Any) -> str:
    """TeX between the marks of arithmatex as MathML, which browsers show without a script."""
    pattern = r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>'
    return re.sub(pattern, lambda found: mathml(unescape(found[3]), found[2] == "["), html, flags=re.DOTALL)


def mathml(tex: str, block: bool) -> str:
    """Mathematics as MathML; bold letters as characters of their own, since browsers no longer know the attribute."""
    text = convert(tex, display="block" if block else "inline")
    return re.sub(r'<mi mathvariant="bold">([A-Za-z])</mi>', lambda found: f"<mi>{bold(found[1])}</mi>", text)


def bold(letter: str) -> str:
    """The mathematical bold letter."""
    return chr((0x1D400 - ord("A") if letter < "a" else 0x1D41A - ord("a")) + ord(letter))


def commands() -> str:
    """The command reference, from the parsers themselves."""
    lines = ["# Commands", "", "`plyflow -h` lists them, `plyflow COMMAND -h` says the same as this page.", ""]
    for panel, _, names in GROUPS:
        lines += [f"## {panel}", ""]
        for name in names:
            lines += described(f"plyflow {name}", load(name))
    return "\n".join(lines)


def described(name: str, command: Any) -> list[str]:
    """Help and parameters of a command, or of each command of a group."""
    inner = getattr(command, "commands", None)
    if inner:
        return [line for key, one in inner.items() for line in described(f"{name} {key}", one)]
    said = re.sub(r"\n(?!\n)", " ", command.help or "").strip()
    lines = [f"### `{name}`", "", re.sub(r"\n ", "\n\n", said), "", "| option | meaning | default |", "| --- | --- | --- |"]
    for parameter in command.params:
        words = " ".join(part for part in (getattr(parameter, "help", "") or "").split())
        names = ", ".join(f"`{one}`" for one in (*parameter.opts, *parameter.secondary_opts))
        shown = f"`{parameter.metavar or parameter.name.upper()}`" if parameter.param_type_name == "argument" else names
        default = "required" if parameter.required else "" if parameter.default in (None, False, ()) else f"`{parameter.default}`"
        lines.append(f"| {shown} | {escape(words, quote=False).replace('|', '&#124;')} | {default} |")
    return [*lines, ""]


def gallery() -> tuple[str, dict[str, bytes]]:
    """The page of examples with a picture that each command makes, and the pictures; the commands are run here."""
    text = (GALLERY / "README.md").read_text(encoding="utf-8").replace("# Examples", "# Gallery", 1)
    pictures: dict[str, bytes] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(copytree(GALLERY, Path(name) / "examples"))

        def shown(block: re.Match[str]) -> str:
            before = set(folder.rglob("*.svg"))
            run([line for line in block[1].splitlines() if not NEEDS_ABAQUS.fullmatch(line)], folder)
            made = sorted(set(folder.rglob("*.svg")) - before)[:PICTURES]
            pictures.update({f"gallery/{path.parent.name}-{path.name}": path.read_bytes() for path in made})
            links = [f"![{path.stem} of {path.parent.name}](gallery/{path.parent.name}-{path.name})" for path in made]
            return "\n\n".join([block[0], *links])

        return re.sub(r"^```sh\n(.*?)^```$", shown, text, flags=re.DOTALL | re.MULTILINE), pictures


def figures() -> dict[str, bytes]:
    """Pictures of the pages from the model itself, made here."""
    with tempfile.TemporaryDirectory() as name:
        run([f"plyflow figures --no-map --only {FIGURES} -o {name}"], ROOT)
        return {f"made/{path.name}": path.read_bytes() for path in Path(name).glob("*.svg")}


def run(lines: list[str], folder: Path) -> None:
    """Run commands of the gallery with the plyflow of this Python.

    Raises
    ------
    PluginError
        One fails.
    """
    for line in lines:
        words = line.split(" ", 1)
        path = str(Path(sys.executable).parent / words[0])
        done = subprocess.run(
            f"{path} {words[1]}", shell=True, cwd=folder, env=os.environ | ENVIRONMENT, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise PluginError(f"{line}: {done.stderr}")
