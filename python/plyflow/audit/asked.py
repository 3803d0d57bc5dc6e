"""What an auditor asks next of the emitted law, each answered by a computation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import mpmath as mp
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from plyflow.audit.creep import Reference
from plyflow.audit.machine import call
from plyflow.law import Stage, log_viscosity
from plyflow.umat import compile as compiling
from plyflow.umat.library import UmatLibrary
from umataudit import State, random_states
from umataudit.domain import elastic_curvature
from umataudit.printed.tables import COLUMNS, TABLE_4
from umataudit.render import expression_text
from umataudit.whole import expected_call
from umatgen.model import viscous
from umatgen.notation import sym
from umatgen.scene import Scene

Array = NDArray[np.float64]
_EXACT, _COMPRESSED = 1.0e-11, 0.1


@dataclass(frozen=True)
class Answer:
    """A question, whether it is answered by yes, and the number behind the answer."""

    question: str
    holds: bool
    answer: str


def answers(reference: Reference) -> list[Answer]:
    """All questions; `reference` is the case of the consequences."""
    return [*viscous_potential(), *invariance(), fibre_compression(), *uniqueness(reference), frozen_tangent()]


def viscous_potential() -> list[Answer]:
    """Power over psi_v and its Hessian to Cdot from the model's potential; and the stress where J2 leaves rates out."""
    (j2, a), least = sym("j2_eff", "a_rate"), min(float(column.a) for column in COLUMNS)
    psi = [viscous.potential(stage) for stage in viscous.STAGES]
    powers = {sp.simplify(2 * j2 * p.diff(j2) / p) for p in psi}
    ratios = {sp.simplify(1 + 2 * j2 * p.diff(j2, 2) / p.diff(j2)) for p in psi}
    (power, ratio) = powers.pop(), ratios.pop()
    x, y, square = sp.symbols("x y q", positive=True)  # rates through the thickness and in the plane; S is g times them
    g = x**a
    curl = sp.simplify(((g * x).diff(y) - (g * y).diff(x)) / (g * y / x))
    smallest = sp.Matrix([[(g * x).diff(x), (g * y).diff(x) / 2], [(g * y).diff(x) / 2, g]]).det()
    (bound,) = sp.solve(sp.simplify(smallest.subs(y, x * sp.sqrt(square)) / g**2), square)
    most = [math.sqrt(bound.subs(a, value)) for value in (least, -0.866)]
    return [
        Answer(
            "is the dissipation never negative?", not powers and power == a + 2,
            f"it is $({expression_text(power)}) psi_v$, and $psi_v >= 0$",
        ),
        Answer(
            "is $psi_v$ convex in $Cdot$?", not ratios and bool(ratio.subs(a, least) > 0),
            f"its curvature along $Cdot$ over that across is ${expression_text(ratio)}$: for $a > -1$; "
            f"{1 + least:.3f} at the least $a$ of the tables",
        ),
        Answer(
            "is the stress the gradient of $psi_v$ in the increment that passes the lock?", curl == 0,
            "only where the rates in the ply plane vanish, as at a free edge: $J2$ leaves them out there, the stress does not. Its "
            f"power is positive; it grows with the rate for rates in the plane up to {most[0]:.2g} times those through "
            f"the thickness at the least $a$, {most[1]:.2g} at $a = -0.866$",
        ),
    ]  # fmt: skip


def invariance() -> list[Answer]:
    """Compiled stress under rotations of space, and of the material: half turns about its axes, a turn about the fibre."""
    source, manifest, _ = compiling.generate_cached(Scene())
    library = UmatLibrary(compiling.compile_umat(source))
    states = [replace(state, past=None) for state in random_states(manifest, 6)]
    turn, _ = np.linalg.qr(np.array([[1.0, 2.0, -1.0], [0.5, -1.0, 3.0], [2.0, 0.3, 1.0]]))
    turn *= np.sign(np.linalg.det(turn))
    about_fibre = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    halves = [np.diag(d) for d in ([1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0])]

    def worst(left: Array, right: Array) -> float:
        def change(state: State) -> float:
            before, after = (_tensor(call(library, s, manifest).stress) for s in (state, _turned(state, left, right)))
            return float(np.abs(after - left @ before @ left.T).max() / np.abs(before).max())

        return max(map(change, states))

    space, material = worst(turn, np.eye(3)), max(worst(np.eye(3), half) for half in halves)
    fibre = worst(np.eye(3), about_fibre)
    return [
        Answer("is the emitted stress objective?", space < _EXACT, f"largest relative change ${space:.0e}$ when the body is turned"),
        Answer("has it the symmetry of fibre and normal?", material < _EXACT, f"${material:.0e}$ under half turns about their axes"),
        Answer(
            "is it transversely isotropic, as section 4.1 says?", fibre < _EXACT,
            f"it changes by {fibre:.2g} times itself in a quarter turn about the fibre: the ply normal counts as a second axis",
        ),
    ]  # fmt: skip


def _tensor(voigt: Array) -> Array:
    s = voigt
    return np.array([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]])


def _turned(state: State, left: Array, right: Array) -> State:
    f0, f1 = ((left @ np.array(f, dtype=float) @ right).tolist() for f in (state.f0, state.f1))
    return replace(state, f0=[[mp.mpf(v) for v in row] for row in f0], f1=[[mp.mpf(v) for v in row] for row in f1])


def fibre_compression() -> Answer:
    """Fibre strain at which the elastic part of Table 4 loses rank-one convexity: d2W(F + t m N)/dt2 in the plane of the fibre."""
    curvature = elastic_curvature()
    angles = np.linspace(0.0, np.pi, 181)
    p, q = np.meshgrid(angles, angles)
    low, high = 1.0e-12, _COMPRESSED
    for _ in range(60):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if float(np.min(curvature(1.0 - middle, p, q))) < 0.0 else (middle, high)
    return Answer(
        "is the elastic part rank-one convex in fibre compression?", high > 0.999 * _COMPRESSED,
        f"to a fibre strain of $-{high:.3g}$: the fibre stress is $-G_LT$ there; $-G_LT/E_L$ of Table 4 is "
        f"$-{_shear_over_axial():.3g}$",
    )  # fmt: skip


def _shear_over_axial() -> float:
    return float(TABLE_4["G13"]) / float(TABLE_4["E1"])


def uniqueness(reference: Reference) -> list[Answer]:
    """Stress of one increment over the strain at its end, across the lock: at its end's viscosity, and with the creep-exact mean."""
    law = reference.law
    start = law.eps_lock + 2.0e-3
    eps = np.concatenate([np.linspace(start - 1e-6, law.eps_lock, 2001)[:-1], np.linspace(law.eps_lock, start - 1e-2, 2001)[1:]])
    log_eta = np.where(eps > law.eps_lock, log_viscosity(eps, law, Stage.SQUEEZE), log_viscosity(eps, law, Stage.BLEED))
    point = log_eta + (law.a + 1) * np.log(start - eps)
    pieces = np.logaddexp(law.rate_exponent * log_eta[1:], law.rate_exponent * log_eta[:-1]) + np.log(-np.diff(eps) / 2)
    mean = np.logaddexp.accumulate(pieces) / law.rate_exponent
    said = []
    for name, log_stress in (("at the viscosity of its end (bdf1)", point), ("with the creep-exact mean", mean)):
        drop = float(np.max(np.maximum.accumulate(log_stress) - log_stress))
        level = float(np.max(log_stress[:1990])) - drop / 2 - 1e-9
        roots = int(np.count_nonzero(np.diff(np.sign(log_stress - level))))
        text = f"the stress {'falls by ' + format(-math.expm1(-drop), '.1%') if drop > 1e-12 else 'never falls'}; solutions: {roots}"
        said.append(Answer(f"has an increment across the lock one solution {name}?", drop < 1e-12, text))
    return said


def frozen_tangent() -> Answer:
    """DDSDDE of Eq. 16 (f held fixed) against the differentiated stress, for increments that are halved."""
    (state,) = random_states({"name": "asked", "scene": {"tangent": "paper", "regimes": "bleed"}}, 1)
    errors = []
    for h in (mp.mpf("1e-3"), mp.mpf("5e-4"), mp.mpf("2.5e-4")):
        end = (mp.matrix(state.f0) * mp.diag([1, 1, mp.exp(-h)])).tolist()
        smaller = replace(state, f1=end, dt=h)
        frozen, exact = (mp.matrix(expected_call(smaller, {"tangent": kind})[1]) for kind in ("paper", "consistent"))
        errors.append(float(mp.mnorm(frozen - exact, 1) / mp.mnorm(exact, 1)))
    order = math.log2(errors[1] / errors[2])
    sizes = ", ".join(f"{error:.2g}" for error in errors)
    return Answer(
        "is the tangent of Eq. 16, $f$ held fixed (scene `paper`), consistent?", max(errors) < _EXACT,
        f"off by {sizes} for strain increments of 0.001 and its halves: order {order:.2f} in the increment",
    )  # fmt: skip
