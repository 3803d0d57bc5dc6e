"""The creep-exact increment: against forty digits before, across and after the lock, exact for creep, of second order else."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp

from emitted import generate
from oracle import Properties, State, crossing_states, random_states
from oracle.algebra import right_cauchy_green, tensor
from oracle.compare import relative_error
from oracle.creep import Past, creep_witness, mean_factor
from plyflow.case.case import Case, driver_steps, law_parameters, property_values, props_vector
from plyflow.driver.drive import Controls, drive
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
        errors.append(
            (
                relative_error(found.stress, sigma),
                relative_error(found.ddsdde, tangent),
                abs(found.statev[MEAN] / mean - 1),
            )
        )
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
        ("before", "(dflow_stretch + dlnr)", "dflow_stretch"),
        ("across", "b_squeeze + eps_lock", "b_squeeze + 1.01d0*eps_lock"),
        ("after", "mean = left*panel*(place", "mean = 1.0001d0*left*panel*(place"),
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


def crept(size: float, scene: str) -> tuple[float, float]:
    """Error of the final thickness ratio after a ramp of 1 s and 1000 s under 0.05 MPa in increments of a size [s]; width ratio."""
    umat, load = prepare_umat(scene), LoadProgramme((0.0, 1.0, 1001.0), (0.0, 0.05, 0.05))
    values = property_values(CASE, umat.manifest)
    controls = Controls(initial_increment=1e-3, maximum_increment=size, growth=3.0, easy_in_a_row=1)
    props, states = np.array(props_vector(values, umat.manifest)), len(umat.manifest["statev"])
    history = drive(umat.library, props, states, driver_steps(load), controls)
    assert history.completed, history.message
    law = integrate(law_parameters(values), load, np.array([load.end]))
    end = history.deformation_gradient[-1]
    return float(end[2, 2] - law.thickness_ratio[-1]), float(end[1, 1] / law.width_ratio[-1])


@pytest.mark.parametrize("size", [10.0, 100.0, 500.0])
def test_creep_is_exact_whatever_the_increment(size: float) -> None:
    """What is left is the error of the ramp."""
    error, width = crept(size, "default")
    assert abs(error) < 1e-5
    assert width == pytest.approx(1.0, abs=1e-4)


def test_the_backward_difference_is_not() -> None:
    assert abs(crept(500.0, "bdf1")[0]) > 1e-4


def test_a_ramp_is_met_with_second_order() -> None:
    """Halving all increments of a slow ramp quarters the error of the final thickness."""
    case, umat = Case("IM7-8552", 70.0, "BP", 15.0, "monotonic"), prepare_umat("default")
    errors = []
    for refinement in (1.0, 2.0, 4.0):
        result = run_case(case, umat, case_controls(refinement))
        errors.append(abs(result.thickness_ratio[-1] - result.law.thickness_ratio[-1]))
    assert errors[0] / errors[1] > 2.8
    assert errors[1] / errors[2] > 2.8
