"""The creep-exact increment: against forty digits before, across and after the lock, exact for creep, of second order else."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp

from emitted import generate
from oracle import PROPERTY_NAMES, Properties, State, crossing_states, random_states
from oracle.algebra import right_cauchy_green, tensor
from oracle.compare import relative_error
from oracle.creep import Past, creep_witness, mean_factor
from plyflow.case.case import PLY_KINDS, Case, law_parameters, property_values, props_vector
from plyflow.driver.drive import Controls, Step, drive
from plyflow.law import LoadProgramme, integrate
from plyflow.run.case_run import case_controls, run_case
from plyflow.umat.compile import compile_umat
from plyflow.umat.library import CallResult, UmatLibrary
from plyflow.umat.prepare import prepare_umat
from umatgen.scene import SCENES

LOCKED, RATE, MEAN, LENGTH = 4, 6, 8, 9
STRESS_TOLERANCE, DDSDDE_TOLERANCE = 1.0e-12, 1.0e-9
DRAWN = {
    "before": lambda: random_states(61, 12, locked=False),
    "across": lambda: crossing_states(62, 12),
    "after": lambda: random_states(63, 12, locked=True),
}


@pytest.fixture(scope="module")
def creep() -> UmatLibrary:
    return UmatLibrary(compile_umat(generate(SCENES["default"]).source))


def pasts(states: list[State]) -> list[Past | None]:
    """No past, or one of 0.3 to 3 times the mean stress and length, compacting or opening."""
    rng = np.random.default_rng(64)
    found: list[Past | None] = []
    for i, state in enumerate(states):
        mean = creep_witness(state, None)[2]
        factor, length = np.exp(rng.uniform(-1.2, 1.2, size=2))
        past = Past(float(factor * mean), float(length * state.time_increment), rng.choice([-1.0, 1.0]) * 1e-3)
        found.append(None if i % 3 == 0 else past)
    return found


def answer(library: UmatLibrary, state: State, past: Past | None) -> CallResult:
    statev = np.zeros(10)
    statev[LOCKED] = float(state.locked)
    if past is not None:
        statev[[RATE, MEAN, LENGTH]] = past.rate, past.stress, past.length
    arguments = (state.start, state.end, state.time_increment, state.props, statev)
    return library.call(*arguments, increment=2 if past else 1)


def worst(library: UmatLibrary, states: list[State]) -> tuple[float, float, float]:
    """Largest relative errors of stress, DDSDDE and mean stress."""
    errors = []
    for state, past in zip(states, pasts(states), strict=True):
        found, (sigma, tangent, mean) = answer(library, state, past), creep_witness(state, past)
        errors.append((relative_error(found.stress, sigma), relative_error(found.ddsdde, tangent), abs(found.statev[MEAN] / mean - 1)))
    return tuple(np.max(errors, axis=0))  # type: ignore[return-value]


@pytest.mark.parametrize("stage", DRAWN)
def test_stress_and_ddsdde_match_forty_digits(creep: UmatLibrary, stage: str) -> None:
    stress, tangent, mean = worst(creep, DRAWN[stage]())
    assert stress <= STRESS_TOLERANCE
    assert tangent <= DDSDDE_TOLERANCE
    assert mean <= STRESS_TOLERANCE


@pytest.mark.parametrize(
    ("stage", "statement", "planted"),
    [
        ("before", "dlnr + dflow_stretch", "dflow_stretch"),
        ("across", "eps_lock", "1.01d0*eps_lock"),
        ("after", "place_left)*left*panel", "place_left)*left*panel*1.0001d0"),
    ],
)
def test_planted_errors_are_seen(stage: str, statement: str, planted: str) -> None:
    source = generate(SCENES["default"]).source
    head, tail = source.split("CONTAINS", 1)
    assert statement in tail
    broken = UmatLibrary(compile_umat(head + "CONTAINS" + tail.replace(statement, planted)))
    stress, tangent, _ = worst(broken, DRAWN[stage]())
    assert stress > 1e-9 or tangent > 1e-7


def test_eight_panels_stand_for_the_integral() -> None:
    """The 1/m-th power forgives the quadrature: within 2e-3 of the stress for strains of an increment up to 0.1."""
    errors = []
    for state in [*random_states(65, 6, False, (1e-2, 1e-1)), *random_states(66, 6, True, (1e-2, 1e-1))]:
        with mp.workdps(25):
            p = Properties.of(state.props)
            c0, c1 = (right_cauchy_green(tensor(f)) for f in (state.start, state.end))
            by_panels, exact = (mean_factor(c0, c1, p, state.locked, panels)[0] for panels in (8, 0))
            errors.append(abs(float(by_panels / exact) - 1))
    assert max(errors) < 2e-3


CASE = Case("IM7-8552", 70.0, "BP", 15.0)


def crept(pressure: float, size: float, scene: str) -> tuple[float, float]:
    """Error of the final thickness ratio after 100 s under a pressure [MPa] in increments of a size [s], and the width ratio."""
    umat = prepare_umat(scene)
    values = property_values(CASE, umat.manifest)
    targets = {"11": 1.0, "22": 0.0, "33": pressure, "12": 0.0, "13": 0.0, "23": 0.0}
    step = Step(duration=100.0, targets=targets, kinds=PLY_KINDS, instant=True)
    controls = Controls(initial_increment=size, maximum_increment=size, growth=1.0, minimum_increment=1e-12)
    history = drive(umat.library, np.array(props_vector(values, umat.manifest)), len(umat.manifest["statev"]), [step], controls)
    assert history.completed, history.message
    load = LoadProgramme((0.0, 1e-9, 100.0), (0.0, pressure, pressure))
    law = integrate(law_parameters(values), load, np.array([100.0]))
    return float(history.f_end[-1][2, 2] - law.thickness_ratio[-1]), float(history.f_end[-1][1, 1] / law.width_ratio[-1])


@pytest.mark.parametrize("size", [0.5, 10.0, 50.0])
def test_creep_is_exact_whatever_the_increment_the_lock_included(size: float) -> None:
    """A pressure at once: the first increment passes the lock. The backward difference is 1e-3 to 1e-2 off."""
    error, width = crept(0.05, size, "default")
    assert abs(error) < 5e-6
    assert width == pytest.approx(1.0, abs=1e-4)


def test_the_backward_difference_is_not() -> None:
    assert abs(crept(0.05, 50.0, "bdf1")[0]) > 1e-4


def test_a_ramp_is_met_with_second_order() -> None:
    """Halving all increments of a slow ramp quarters the error of the final thickness."""
    case, umat = Case("IM7-8552", 70.0, "BP", 15.0, "monotonic"), prepare_umat("default")
    errors = []
    for refinement in (1.0, 2.0, 4.0):
        result = run_case(case, umat, case_controls(refinement))
        errors.append(abs(result.thickness_ratio[-1] - result.law.thickness_ratio[-1]))
    assert errors[0] / errors[1] > 2.8
    assert errors[1] / errors[2] > 2.8
