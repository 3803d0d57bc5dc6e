"""The `plyflow` command: one module for each group of commands, each with a function `register(app)`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import typer

from plyflow.cli import (
    abaqus,
    audit,
    bench,
    calculix,
    demo,
    doctor,
    drive,
    figures,
    generate,
    identify,
    law1d,
    replay,
    run,
    scenes,
    stability,
    sweep,
)
from plyflow.errors import PlyflowError
from plyflow.provenance import package_version

# The base of the errors of the command line parser, wherever the installed Typer keeps it.
USAGE_ERROR: Any = next(
    base for base in reversed(typer.BadParameter.__mro__) if "format_message" in vars(base)
)
COMMAND_MODULES = (
    generate, run, replay, demo, scenes, law1d, identify, audit, stability, drive, abaqus, calculix, doctor,
    sweep, figures, bench,
)  # fmt: skip

app = typer.Typer(
    name="plyflow",
    help="Compaction of toughened prepregs: from potentials to a running UMAT.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


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


for module in COMMAND_MODULES:
    module.register(app)


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
