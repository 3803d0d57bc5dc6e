"""Increments for property-based tests: any stretch, shear, rotation, size and time that the stage admits."""

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from plyflow.evidence.stability.states import Increment, admissible, held_width
from plyflow.evidence.stability.subject import Subject
from plyflow.evidence.stability.tensors import Array, limit_stretch, rotation

SUBJECT = Subject(quick=True)
small = st.floats(-0.1, 0.1)
turns = st.floats(0.0, 360.0)


@st.composite
def rotations(draw: st.DrawFn) -> Array:
    """Any rotation, as three turns about coordinate axes."""
    return np.asarray(rotation(0, draw(turns)) @ rotation(1, draw(turns)) @ rotation(0, draw(turns)))


@st.composite
def increments(draw: st.DrawFn, least: float = 1e-3) -> Increment:
    """One increment of at least `least` of strain, with moderate stiffness so that its condition is good."""
    column = draw(st.sampled_from(SUBJECT.columns))
    stiffness = {name: 10.0 ** draw(st.floats(-3.0, 0.0)) for name in ("E_L", "E_T", "G_LT", "kappa")}
    values = SUBJECT.values(column, **stiffness) | {"nu_LT": 0.1, "nu_TT": draw(st.floats(-0.3, 0.6))}
    values["E_L"] = max(values["E_L"], values["E_T"])
    locked = draw(st.booleans())
    end = _stretch(draw, values, locked)
    motion = np.array([[draw(small) for _ in range(3)] for _ in range(3)])
    assume(np.linalg.norm(motion) > least)
    start = end - motion @ end
    assume(admissible(start, values, locked) and admissible(end, values, locked))
    return Increment(start, end, 10.0 ** draw(st.floats(-10.0, 6.0)), values, locked)


def _stretch(draw: st.DrawFn, values: dict[str, float], locked: bool) -> Array:
    """Transverse stretches about any axes, fibre stretch, fibre shear."""
    lock, limit = values["eps_lock"], float(np.log(limit_stretch(values)))
    share = draw(st.floats(0.0, 1.0))
    eps = lock + share * (limit - lock) if locked else share * lock
    end = held_width(eps, values)
    end[0, 0] = 1.0 + draw(small)
    end[1, 1] = (end[1, 1] if locked else np.exp(-eps)) * (1.0 + draw(small))
    turn = rotation(0, draw(turns))
    end = turn @ end @ turn.T
    end[1:, 0] = draw(small), draw(small)
    return np.asarray(end)
