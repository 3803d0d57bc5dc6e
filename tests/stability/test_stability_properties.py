"""Properties of the emitted UMAT for any admissible increment: objectivity, symmetry, limit laws, dissipation."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from planting import ERRORS
from plyflow.case.case import law_parameters
from plyflow.evidence.stability.ledger import viscous_work
from plyflow.evidence.stability.objectivity import turned_errors
from plyflow.evidence.stability.rates import called_viscous_stress, rate_factor
from plyflow.evidence.stability.rounding import measure_rounding
from plyflow.evidence.stability.states import Increment, held_width, stage_increment
from plyflow.evidence.stability.subject import Column, Subject, Values
from plyflow.evidence.stability.tensors import (
    EPSILON,
    Array,
    green,
    limit_stretch,
    rotation,
    second_piola,
    tensor,
)
from plyflow.law import compaction_stress
from stability.strategies import SUBJECT, increments, rotations

EXAMPLES = settings(max_examples=60, deadline=None, derandomize=True)
LEAST_TOLERANCE = 1e-12
columns = st.sampled_from(SUBJECT.columns)
WRONG, BLUNT, STEEP, FLOORLESS, DRIVING = (
    Subject(quick=True, edit=ERRORS[error])
    for error in (
        "a stress that is not turned",
        "no resistance at the limit",
        "a rate exponent of zero or less",
        "no floor of the rate",
        "a viscous stress that drives",
    )
)


def tolerance(one: Increment) -> float:
    """Rounding: 1e-12, or eight times what the doubles of the input leave open."""
    rounding = measure_rounding(SUBJECT, *one)
    return max(LEAST_TOLERANCE, 8.0 * EPSILON * rounding.condition)


def turned_error(subject: Subject, one: Increment, turn: Array) -> tuple[float, float]:
    """Differences of stress and tangent between the turned answer and the answer to the turned end."""
    return turned_errors(subject.call(*one), subject.call(*one._replace(end=turn @ one.end)), turn)


def stretch_gap(gradient: Array) -> float:
    """Relative gap of the two transverse stretches: the tangent turns with the direction of the smaller one."""
    least, largest = np.linalg.eigvalsh(green(gradient)[1:, 1:])
    return float(max((largest - least) / largest, EPSILON))


@EXAMPLES
@given(increments(), rotations())
def test_stress_and_tangent_turn_with_a_superposed_rotation(one: Increment, turn: Array) -> None:
    stress, tangent = turned_error(SUBJECT, one, turn)
    assert stress <= tolerance(one)
    assert tangent <= tolerance(one) + 16.0 * EPSILON / stretch_gap(one.end)


def test_rotation_check_sees_a_stress_that_does_not_turn() -> None:
    values = SUBJECT.values(SUBJECT.columns[4], kappa=1.0, E_L=1.0)
    one = Increment(*stage_increment(values, False, 1e-2), 1.0, values, False)
    assert turned_error(SUBJECT, one, rotation(2, 30.0))[0] <= tolerance(one)
    assert turned_error(WRONG, one, rotation(2, 30.0))[0] > tolerance(one)


@EXAMPLES
@given(increments(), st.integers(0, 2))
def test_half_a_turn_about_an_axis_of_the_ply_before_it_is_loaded_changes_nothing(one: Increment, axis: int) -> None:
    """Fibre, direction across and ply normal: what compaction along the normal leaves of transverse isotropy."""
    turns = (np.eye(3), np.round(rotation(axis, 180.0)))
    answers = [SUBJECT.call(one.start @ turn, one.end @ turn, one.dt, one.values, one.locked) for turn in turns]
    difference = np.abs(answers[0].stress - answers[1].stress).max() / np.abs(answers[0].stress).max()
    assert difference <= tolerance(one)


def stress_of_energy(subject: Subject, one: Increment) -> Array:
    """Cauchy stress (3, 3) as (1/J) dSSE/dF F^T with all nine components of F moved: not symmetric by construction."""
    step, derivative = 1e-5, np.zeros((3, 3))
    for index in np.ndindex(3, 3):
        ends = []
        for sign in (1.0, -1.0):
            moved = one.end.copy()
            moved[index] += sign * step
            ends.append(subject.call(moved, moved, 1.0, one.values, one.locked).sse)
        derivative[index] = (ends[0] - ends[1]) / (2.0 * step)
    return np.asarray(derivative @ one.end.T / np.linalg.det(one.end))


@EXAMPLES
@given(increments())
def test_stress_derived_from_the_energy_is_symmetric_and_the_stress_at_rest(one: Increment) -> None:
    derived = stress_of_energy(SUBJECT, one)
    found = tensor(SUBJECT.call(one.end, one.end, 1.0, one.values, one.locked).stress)
    scale = max(np.abs(found).max(), 1e-3 * one.values["E_L"])
    assert np.abs(derived - derived.T).max() <= 1e-7 * scale
    assert np.abs(derived - found).max() <= 1e-7 * scale


def test_symmetry_check_sees_a_stress_that_is_not_the_energys() -> None:
    values = SUBJECT.values(SUBJECT.columns[4], kappa=0.0, E_L=1e-3, E_T=1e-3, G_LT=1e-3)
    one = Increment(*stage_increment(values, True, 1e-2), 1.0, values, True)
    found = tensor(WRONG.call(one.end, one.end, 1.0, values, True).stress)
    assert np.abs(stress_of_energy(WRONG, one) - found).max() > 1e-7 * max(np.abs(found).max(), 1e-3 * values["E_L"])


@EXAMPLES
@given(increments())
def test_viscous_stress_never_gives_work(one: Increment) -> None:
    for scene in ("default", "bdf1"):
        least, allowed, dissipation = dissipation_of(SUBJECT, one, scene)
        assert least >= -allowed
        assert dissipation >= 0.0


def dissipation_of(subject: Subject, one: Increment, scene: str = "bdf1") -> tuple[float, float, float]:
    """Work of the viscous stress, what rounding may take from it, and SCD; MPa."""
    answer = subject.call(*one, scene)
    stress = second_piola(answer.stress, one.end)[None]
    work, allowed = viscous_work(stress, np.array(one[:2]), np.array([subject.statev(one.locked, scene), answer.statev]), one.values)
    return float(work[0]), float(allowed[0]), answer.scd


@EXAMPLES
@given(increments())
def test_dissipation_is_the_work_of_the_viscous_stress(one: Increment) -> None:
    """Backward difference; for the creep-exact scene see the rows of the matrix on energy."""
    work, allowed, dissipation = dissipation_of(SUBJECT, one)
    assert abs(work - dissipation) <= allowed + 1e-10 * abs(work)


def test_dissipation_check_sees_a_stress_that_drives() -> None:
    values = SUBJECT.values(SUBJECT.columns[4])
    one = Increment(*stage_increment(values, False, 1e-2), 1.0, values, False)
    least, allowed, _ = dissipation_of(DRIVING, one)
    assert least < -allowed


def bleed_stress(
    subject: Subject, values: Values, stretch: float, rate: float, time: float = 1.0, scene: str = "bdf1"
) -> float:
    """Axial stress of bleeding at the locked width at an exact strain increment of ln(stretch), MPa.

    The strain increment is that of the scene's rate: half the change of C, or the logarithm.
    """
    values = values | {"rate_floor": 1e-150, "strain_floor": 1e-150, "kappa": 0.0}
    values |= {"E_L": 1e-60, "E_T": 1e-60, "G_LT": 1e-60}
    end = held_width(float(np.log(stretch)), values)
    start = end.copy()
    start[2, 2] *= np.sqrt(1.0 - 2.0 * rate) if scene == "bdf1" else np.exp(-rate)
    return float(subject.call(start, end, time, values, True, scene).stress[2])


def law_error(subject: Subject, values: Values, share: float, rate: float) -> float:
    """Difference from the one-dimensional law at a share of the way from the lock to the limit, relative."""
    lock, limit = values["eps_lock"], float(np.log(limit_stretch(values)))
    eps = lock + share * (limit - lock)
    wanted = float(compaction_stress(eps, rate, law_parameters(values)))
    return abs(bleed_stress(subject, values, float(np.exp(eps)), rate) / wanted - 1.0)


def law_tolerance(share: float, rate: float) -> float:
    """An ulp of F beside the gap to the limit and beside the strain increment."""
    return max(LEAST_TOLERANCE, 64.0 * EPSILON * (1.0 / (1.0 - share) + 1.0 / abs(rate)))


@EXAMPLES
@given(columns, st.floats(1e-3, 0.999), st.floats(-6.0, -1.0))
def test_bleeding_is_the_one_dimensional_law(column: Column, share: float, log_rate: float) -> None:
    rate = -(10.0**log_rate)
    assert law_error(SUBJECT, SUBJECT.values(column), share, rate) <= law_tolerance(share, rate)


def creep_error(subject: Subject, values: Values, share: float, pressure: float) -> float:
    """Difference of the stress from the load under which bleeding from the lock to a share takes the time of the law."""
    law = law_parameters(values)
    lock, power = values["eps_lock"], 1.0 / (values["a"] + 1.0)
    eps = lock + share * (float(np.log(limit_stretch(values))) - lock)

    def slowness(strain: float) -> float:
        return float((pressure / -compaction_stress(strain, -1.0, law)) ** -power)

    time = quad(slowness, eps, lock, epsrel=1e-12)[0]
    return abs(-bleed_stress(subject, values, float(np.exp(eps)), eps - lock, time, "default") / pressure - 1.0)


@EXAMPLES
@given(columns, st.floats(1e-2, 0.8), st.floats(0.05, 0.3))
def test_creep_under_a_constant_load_is_exact_in_one_increment(column: Column, share: float, pressure: float) -> None:
    """From the lock to 0.8 of the way to the limit; the quadrature of the path is what is left."""
    assert creep_error(SUBJECT, SUBJECT.values(column), share, pressure) <= 5e-3


def singularity_error(subject: Subject, values: Values, gap: float) -> float:
    """Difference of the stresses at one and at two gaps from the limit from the ratio 4."""
    limit = limit_stretch(values)
    near, far = (bleed_stress(subject, values, limit * (1.0 + distance), -1e-3) for distance in (gap, 2.0 * gap))
    assert near < 0.0 and far < 0.0
    return abs(near / far / 4.0 - 1.0)


@EXAMPLES
@given(columns, st.floats(-7.0, -3.0))
def test_stress_grows_with_the_inverse_square_of_the_gap_to_the_limit(column: Column, log_gap: float) -> None:
    gap = 10.0**log_gap
    assert singularity_error(SUBJECT, SUBJECT.values(column), gap) <= 10.0 * gap + 1e-14 / gap


def power_law_error(subject: Subject, one: Increment, factor: float) -> float:
    """Change of the viscous stress / ((J2 + floor)^(a/2) Cdot) when the time is stretched, in units of rounding."""
    times, scaled = (one.dt, one.dt * factor), []
    for dt in times:
        flow, _ = called_viscous_stress(subject, one._replace(dt=dt))
        scaled.append(flow / rate_factor(one.start, one.end, dt, one.values))
    stiffness = sum(one.values[name] for name in ("E_L", "E_T", "G_LT", "kappa"))
    noise = 64.0 * EPSILON * stiffness / min(rate_factor(one.start, one.end, dt, one.values) for dt in times)
    return float(np.abs(scaled[0] - scaled[1]).max() / (1e-12 * np.abs(scaled[0]).max() + noise))


@EXAMPLES
@given(increments(), st.floats(-3.0, 3.0))
def test_stress_follows_the_power_law_of_the_rate(one: Increment, log_factor: float) -> None:
    assert power_law_error(SUBJECT, one, 10.0**log_factor) <= 1.0


def linearity_error(subject: Subject, values: Values, locked: bool, share: float) -> float:
    """Change of stress / strain from a share of the floor to twice that share, relative."""
    values = values | {"strain_floor": 1e-3, "kappa": 0.0}
    _, end = stage_increment(values, locked, 1e-2)
    secants = []
    for factor in (1.0, 2.0):
        size = factor * share * values["strain_floor"]
        start = end @ np.diag([1.0, np.sqrt(1.0 - size), np.sqrt(1.0 + size)])
        flow, _ = called_viscous_stress(subject, Increment(start, end, 1.0, values, locked))
        secants.append(flow[2, 2] / (green(end) - green(start))[2, 2])
    return float(abs(secants[0] / secants[1] - 1.0))


def linearity_tolerance(share: float) -> float:
    """Second order in the share, and rounding of F beside the strain."""
    return 100.0 * share**2 + 1e-12 / share


@EXAMPLES
@given(columns, st.booleans(), st.floats(-5.0, -2.5))
def test_below_the_floor_the_law_is_linear(column: Column, locked: bool, log_share: float) -> None:
    share = 10.0**log_share
    assert linearity_error(SUBJECT, SUBJECT.values(column), locked, share) <= linearity_tolerance(share)


def test_limit_laws_see_another_exponent_of_the_gap_and_of_the_rate() -> None:
    values = SUBJECT.values(SUBJECT.columns[4])
    one = Increment(*stage_increment(values, True, 1e-2), 1.0, values, True)
    assert singularity_error(BLUNT, values, 1e-4) > 10.0 * 1e-4
    assert law_error(BLUNT, values, 0.5, -1e-3) > law_tolerance(0.5, -1e-3)
    assert creep_error(BLUNT, values, 0.5, 0.1) > 5e-3
    assert power_law_error(STEEP, one, 10.0) > 1.0
    assert linearity_error(FLOORLESS, values, True, 1e-4) > linearity_tolerance(1e-4)
