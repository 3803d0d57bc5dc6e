"""The `plyflow` command: a table of all commands; the module of a command is imported when it is called."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from plyflow.errors import PlyflowError
from plyflow.provenance import package_version

# Heading in the help, module, first sentence of each command (the same as in its own help, which a test asserts).
GROUPS: tuple[tuple[str, str, dict[str, str]], ...] = (
    ("Scenes, materials and sources", "scene", {
        "generate": "Write the UMAT of a scene (NAME.for) and its manifest (NAME.json); print both paths.",
        "scenes": "List the shipped scenes with the size of each.",
        "explain": "Say, piece by piece, what a scene leaves out against the default one and why it could go.",
        "material": "Print a shipped material, or write it to a file to edit.",
    }),
    ("Cases", "run", {
        "run": "Compact one ply block under the plate and compare with the one-dimensional law.",
        "replay": "Repeat the increment an analysis failed in; exit status 1 if it fails again, 0 if it goes through.",
        "sweep": "Run many cases; stopped or killed, the same command goes on where it was.",
    }),
    ("One-dimensional law", "law", {
        "law1d": "Thickness, width, fibre fraction and flow stage over time; every combination of the repeated options.",
        "identify": "Fit k, a, b_squeeze and b_bleed to compaction tests and write a material file.",
    }),
    ("Checks", "check", {
        "audit": "Compare each relation of the paper with what follows from its premises, and with the compiled UMAT.",
        "drive": "Drive a UMAT and examine it: DDSDDE and what hosts take for granted; exit status 1 if something is bad.",
    }),
    ("Reports", "report", {
        "demo": "Generate, compile and run the 84 cases; end with a table, figures and one HTML report.",
        "figures": "Draw Figs. 2a, 2b, 6a, 6b, 7 to 11 from the model and judge the paper's claims.",
        "stability": "Run the stability matrix; ends with tables as HTML and JSON.",
        "bench": "Measure error against run time for scenes, tangents, integrators, step controls and peers, all in one session.",
    }),
    ("Finite-element hosts", "host", {
        "laminate": "Press a laminate between rigid plates by finite elements; stopped or killed, the same command goes on.",
        "abaqus": "Write source, decks (C3D8, C3D8R, C3D8H, CPE4, CAX4, a laminate) and a README; print their paths.",
        "calculix": "CalculiX as a finite-element host.",
        "canary": "A UMAT that examines its host; alone it is write.",
        "mgis": "A scene as a behaviour for MGIS hosts; SCENE alone is write SCENE.",
    }),
    ("Installation", "doctor", {"doctor": "Say what was found; exit status 1 if something needed is missing."}),
)  # fmt: skip
MODULES = {name: module for _, module, commands in GROUPS for name in commands}
# The base of the errors of the command line parser, wherever the installed Typer keeps it.
USAGE_ERROR: Any = next(base for base in reversed(typer.BadParameter.__mro__) if "format_message" in vars(base))


def load(name: str) -> Any:
    """The parser of a command: its function, or its own group of commands, from its module."""
    found = getattr(import_module(f"plyflow.cli.{MODULES[name]}"), name)
    if not isinstance(found, typer.Typer):
        command, found = found, typer.Typer(add_completion=False)
        found.command(name)(command)
    return typer.main.get_command(found)


class LazyGroup(TyperGroup):
    """Commands by name and first sentence, replaced by the real one when it is called."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Name, command and its arguments; the help of all commands never comes here."""
        name, _, rest = super().resolve_command(ctx, args)
        return name, load(name) if name else None, rest


app = typer.Typer(
    name="plyflow",
    cls=LazyGroup,
    help="Compaction of toughened prepregs: from potentials to a running UMAT.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for _panel, _module, _commands in GROUPS:
    for _name, _help in _commands.items():
        app.command(_name, help=_help, rich_help_panel=_panel)(lambda: None)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"plyflow {package_version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(
        False, "--version", callback=_print_version, is_eager=True, help="Print the version and stop."
    ),
) -> None:
    """Compaction of toughened prepregs: from potentials to a running UMAT."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status; every error is one line on stderr.

    Parameters
    ----------
    arguments : sequence of str, optional
        Arguments after the program name; default those of the process.
    """
    try:
        status = app(args=None if arguments is None else list(arguments), standalone_mode=False)
    except PlyflowError as error:
        return _report(str(error), error.exit_status)
    except USAGE_ERROR as error:
        return _report(error.format_message(), 2)
    except typer.Abort:
        return _report("stopped", 130)
    return status if isinstance(status, int) else 0


def _report(message: str, status: int) -> int:
    if message:  # the parser's only error without one is a missing command, and it has printed the help
        print(f"plyflow: error: {' '.join(message.split())}", file=sys.stderr)
    return status
