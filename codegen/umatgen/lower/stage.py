"""A lowered stage: ordered assignments with what goes in, what comes out, and which equation they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from umatgen.lower.assign import Assignment, OperationCount
from umatgen.notation import TABLE


@dataclass(frozen=True)
class Variable:
    """An input or output of a stage."""

    name: str
    shape: tuple[int, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class Stage:
    """One concept of the emitted code.

    Parameters
    ----------
    name : id of the stage; procedure name without prefix; what manifest and audit call it.
    title, equation : one line, and the number or place in the paper.
    inputs, outputs : in order of the argument list.
    assignments : in order of evaluation.
    local_arrays : arrays used inside only.
    preamble : array statements (Fortran text) before the assignments.
    counts : operations before and after each pass.
    sharing : where common subexpressions are shared: "all", "heads" (not in the components of DDSDDE) or "none".
    """

    name: str
    title: str
    equation: str
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    assignments: Sequence[Assignment]
    local_arrays: tuple[Variable, ...] = ()
    preamble: Sequence[tuple[str, str]] = ()
    counts: tuple[OperationCount, ...] = field(default=())
    sharing: str = "all"


_SYMMETRIC = (
    "cdot", "b_left", "fibre", "fibre_c", "m22", "m33", "m23", "y_rate", "r_visc", "r_lock", "stress",
    "rate_last", "rate_mean", "y_mean", "y_turn", "r_turn",
)  # fmt: skip
SHAPES: dict[str, tuple[int, ...]] = {
    **dict.fromkeys(_SYMMETRIC, (6,)),
    **dict.fromkeys(("f0", "f1", "g0", "g1"), (3, 3)),
    "ddsdde": (6, 6),
}
NOTES = {
    "b_left": "F F^T [-]",
    "fibre": "z z, z = F n [-]",
    "fibre_c": "z (b z) + (b z) z [-]",
    "m22": "(F p2)(F p2) [-]",
    "m33": "(F p3)(F p3) [-]",
    "m23": "(F p2)(F p3) + (F p3)(F p2) [-]",
    "y_rate": "F Cdot F^T [1/s]",
    "rate_last": "(C1 - C0)/dt of the last increment [1/s]",
    "rate_mean": "(C1 - C0)/dt of this increment [1/s]",
    "growth": "growth of the rate from the middle to the end of the increment [-]",
    "turn_dyad": "dCdot = ... + turn_dyad dt (Cdot - growth r) (r:dr) [s]",
    "turn_slope": "dJ2 = ... + turn_slope dt (r:dr) [1/s]",
    "y_mean": "F r F^T, r = rate_mean [1/s]",
    "y_turn": "F (Cdot - growth r) F^T [1/s]",
    "r_turn": "(2 g/J) turn_dyad F r F^T [MPa s]",
    "r_visc": "(g/J) F (2 dln g/dC) F^T [MPa s]",
    "r_lock": "(1/J) F (2 d coefficient of C^-1/dC) F^T [MPa]",
    "s_lock": "how far the lock has gone, 0 to 1",
    "ds_dstretch": "its slope in the stretch",
    "p_stretch": "stretch from I1 and I3 [-]",
    "p_norm2": "(I1-1)**2 - 2 I3 [-]",
    "g_squeeze": "viscous factor of the squeeze stage [MPa s]",
    "g_bleed": "viscous factor of the bleed stage [MPa s]",
    "stress": "Cauchy stress [MPa]",
    "ddsdde": "(1/J) dtau/deps [MPa]",
    "x_start": "smallest eigenvalue of A at the start [-]",
    "det_f_start": "J at the start [-]",
    "c12": "n.C.p2 [-]",
    "c13": "n.C.p3 [-]",
    "g0": "F0 Q, Q = (n, p2, p3) [-]",
    "g1": "F1 Q [-]",
    "width": "transverse stretch across the compaction [-]",
    "eps_rate": "rate of ln(stretch) [1/s]",
    "energy": "stored energy per reference volume [MPa]",
    "pressure": "constraint pressure, compression > 0 [MPa]",
    "power": "viscous power per reference volume [MPa/s]",
}


def variables(names: str) -> tuple[Variable, ...]:
    """Variables by name, separated by blanks, with shape and note from the symbol table."""
    return tuple(Variable(name, SHAPES.get(name, ()), _note(name)) for name in names.split())


def _note(name: str) -> str:
    if name in NOTES:
        return NOTES[name]
    if name in TABLE:
        quantity = TABLE[name]
        return f"{quantity.meaning} [{quantity.unit}]"
    return next((text(name) for start, text in _PATTERNS if name.startswith(start)), "")


_PATTERNS: tuple[tuple[str, Callable[[str], str]], ...] = (
    ("dlng_", lambda name: f"d ln g/d {name[5:]}"),
    ("dlngs_", lambda name: f"d ln g/d {name[6:]} of the squeeze stage"),
    ("dlngb_", lambda name: f"d ln g/d {name[6:]} of the bleed stage"),
    ("dstretch_d", lambda name: f"d p_stretch/d {name[10:]}"),
    ("dnorm2_d", lambda name: f"d p_norm2/d {name[8:]}"),
    ("c_", lambda name: f"coefficient of {name[2:]} in tau [MPa]"),
)


def make_stage(
    name: str,
    title: str,
    equation: str,
    inputs: str,
    outputs: str,
    assignments: Sequence[Assignment],
    local_arrays: tuple[Variable, ...] = (),
    preamble: Sequence[tuple[str, str]] = (),
    sharing: str = "all",
) -> Stage:
    """A stage with its variables looked up."""
    return Stage(
        name, title, equation, variables(inputs), variables(outputs), list(assignments), local_arrays, tuple(preamble), (),
        sharing,
    )  # fmt: skip
