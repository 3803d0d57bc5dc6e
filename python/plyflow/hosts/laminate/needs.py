"""What the laminate needs beyond plyflow's own requirements."""

from __future__ import annotations

from importlib.util import find_spec

from plyflow.errors import ToolError


def require_libraries() -> None:
    """See that the libraries of the extra `laminate` are there.

    Raises
    ------
    ToolError
        One is missing; the message names it.
    """
    for name in ("felupe", "meshio"):
        if find_spec(name) is None:
            raise ToolError(f"{name} is not installed, which laminates need; install it with: pip install 'plyflow[laminate]'")
