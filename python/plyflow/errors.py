"""The errors a user can cause or meet; each becomes one line on stderr and exit status 2."""

from __future__ import annotations


class PlyflowError(Exception):
    """Base of every error plyflow raises on purpose.

    The message is one line: the value, the bound it broke and what to do about it.
    """

    exit_status = 2


class InputError(PlyflowError, ValueError):
    """A value given by the user is outside what the model or the programme admits."""


class ToolError(PlyflowError, RuntimeError):
    """A tool outside Python (a Fortran compiler, a shared library) is missing or failed."""


class RunError(PlyflowError, RuntimeError):
    """A run started and could not be finished."""


class OutputError(PlyflowError, OSError):
    """A file or folder could not be written."""
