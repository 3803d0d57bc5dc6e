"""The oracle's stress and tangent: objectivity, Eq. 1, dissipation, and a second road to the tangent."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from mpmath import mp

from oracle import (
    PROPERTY_NAMES,
    Properties,
    State,
    ddsdde,
    energies,
    kirchhoff,
    law_1d,
    random_states,
    second_piola,
    stress,
)
from oracle.algebra import (
    IDENTITY,
    VOIGT,
    Real,
    Tensor,
    add,
    build,
    congruence,
    contract,
    determinant,
    product,
    right_cauchy_green,
    scale,
    strain_basis,
    subtract,
    tensor,
    transpose,
)
from oracle.response import piola_of
from oracle.viscous import viscous_potential, viscous_stress

STATES = [state for locked in (False, True) for state in random_states(21, 4, locked)]
LABELS = [f"{'bleed' if state.locked else 'squeeze'}, {state.label}" for state in STATES]
each_state = pytest.mark.parametrize("state", STATES, ids=LABELS)


def deviation(a: Iterable[Iterable[Real]], b: Iterable[Iterable[Real]]) -> Real:
    """Largest difference of two arrays relative to the largest entry of the second."""
    pairs = [(x, y) for r, s in zip(a, b, strict=True) for x, y in zip(r, s, strict=True)]
    return max(abs(x - y) for x, y in pairs) / max(abs(y) for _, y in pairs)


def arguments(state: State) -> tuple[Any, Any, Any, Any, bool]:
    return state.start, state.end, state.time_increment, state.props, state.locked


def greens(state: State) -> tuple[Tensor, Tensor]:
    return right_cauchy_green(tensor(state.start)), right_cauchy_green(tensor(state.end))


def exact_rotation(seed: int) -> Tensor:
    """Rotation orthogonal to the working precision, from Rodrigues' vector."""
    a, b, c = (mp.mpf(float(v)) for v in np.random.default_rng(seed).normal(size=3))
    zero = mp.mpf(0)
    skew = ((zero, -c, b), (c, zero, -a), (-b, a, zero))
    return add(IDENTITY, scale(2 / (1 + a * a + b * b + c * c), add(skew, product(skew, skew))))


@each_state
def test_stress_turns_with_the_end_whatever_the_turn_of_the_start(state: State) -> None:
    with mp.workdps(60):
        first, second = exact_rotation(1), exact_rotation(2)
        turned = product(first, tensor(state.start)), product(second, tensor(state.end))
        found = kirchhoff(*turned, state.time_increment, state.props, state.locked, digits=60)
        expected = congruence(second, kirchhoff(*arguments(state), digits=60))
        assert deviation(found, expected) < mp.mpf("1e-40")


@each_state
def test_three_stresses_agree(state: State) -> None:
    with mp.workdps(40):
        f = tensor(state.end)
        pushed = scale(1 / determinant(f), congruence(f, second_piola(*arguments(state))))
        assert deviation(stress(*arguments(state)), pushed) < mp.mpf("1e-36")


@each_state
def test_viscous_stress_is_twice_the_gradient_of_its_potential(state: State) -> None:
    with mp.workdps(90):
        p, dt = Properties.of(state.props), mp.mpf(state.time_increment)
        c0, c = greens(state)
        rate = scale(1 / dt, subtract(c, c0))
        step = mp.sqrt(contract(rate, rate)) * mp.mpf("1e-25")
        found = viscous_stress(c, rate, dt, p, state.locked)
        bound = mp.mpf("1e-30") * mp.sqrt(contract(found, found))
        for component, (i, j) in enumerate(VOIGT):
            e = scale(2 * step, strain_basis(component))
            ahead, behind = (viscous_potential(c, r, dt, p, state.locked) for r in (add(rate, e), subtract(rate, e)))
            assert abs((ahead - behind) / (2 * step) - found[i][j]) < bound


@each_state
def test_flow_dissipates_and_rest_does_not(state: State) -> None:
    assert energies(*arguments(state)).dissipation > 0
    assert energies(state.end, *arguments(state)[1:]).dissipation == 0


def tangent_by_push_forward(state: State) -> list[list[Real]]:
    """push-forward(2 dS/dC)/J + (1/2)(d_ik s_jl + ...), with dS/dC by differences in C itself."""
    f = tensor(state.end)
    det_f = determinant(f)
    sigma = stress(*arguments(state), digits=90)
    pushed = [scale(1 / det_f, congruence(f, slope)) for slope in material_slopes(state)]
    rows = []
    for i, j in VOIGT:
        row = []
        for k, m in VOIGT:
            pulled = congruence(transpose(f), build(lambda r, s, k=k, m=m: half_pair(r, s, k, m)))
            doubled = (pulled[a][b] * (1 if a == b else 2) for a, b in VOIGT)
            material = mp.fsum(weight * slope[i][j] for weight, slope in zip(doubled, pushed, strict=True))
            spin = ((i == k, j, m), (i == m, j, k), (j == k, i, m), (j == m, i, k))
            row.append(material + mp.fsum(sigma[a][b] for on, a, b in spin if on) / 2)
        rows.append(row)
    return rows


def material_slopes(state: State) -> list[Tensor]:
    """2 dS/dC, a tensor for each component of the strain C/2."""
    p, dt = Properties.of(state.props), mp.mpf(state.time_increment)
    c0, c = greens(state)
    step = mp.mpf("1e-25")
    slopes = []
    for component in range(6):
        e = scale(2 * step, strain_basis(component))
        ahead, behind = (piola_of(c0, moved, dt, p, state.locked) for moved in (add(c, e), subtract(c, e)))
        slopes.append(scale(1 / (2 * step), subtract(ahead, behind)))
    return slopes


def half_pair(r: int, s: int, k: int, m: int) -> Real:
    return (mp.mpf((r, s) == (k, m)) + mp.mpf((r, s) == (m, k))) / 2


@each_state
def test_perturbed_kirchhoff_stress_is_the_push_forward_of_eq_17(state: State) -> None:
    with mp.workdps(90):
        assert deviation(ddsdde(*arguments(state)), tangent_by_push_forward(state)) < mp.mpf("1e-20")


@each_state
def test_tangent_is_not_symmetric(state: State) -> None:
    """So that a tangent with f frozen, or made symmetric, cannot pass for the consistent one."""
    tangent = ddsdde(*arguments(state))
    assert deviation(zip(*tangent, strict=True), tangent) > 1e-9


def compaction(row: int, locked: bool, fraction: float) -> tuple[Properties, Real, Real, Tensor, Tensor]:
    """Law, strain, its rate, C and its rate, C11 = 1: isochoric squeezing, or bleeding at the locked width.

    The fraction goes from 0 to 1 between no strain and the lock, or between the lock and the limit.
    """
    values = dict(zip(PROPERTY_NAMES, STATES[row].props, strict=True))
    values |= {"E_L": 1e-300, "E_T": 1e-300, "G_LT": 1e-300, "rate_floor": 0.0, "strain_floor": 0.0}
    p = Properties.of([values[name] for name in PROPERTY_NAMES])
    eps = p.eps_lock * fraction
    if locked:
        eps = p.eps_lock + fraction * (mp.log(p.limit_stretch) - p.eps_lock)
    eps_rate, x, zero = mp.mpf("-0.0625"), mp.exp(2 * eps), mp.mpf(0)
    wide, wide_rate = (p.chi_l, zero) if locked else (1 / x, -2 * eps_rate / x)
    c = ((mp.mpf(1), zero, zero), (zero, wide, zero), (zero, zero, x))
    rate = ((zero, zero, zero), (zero, wide_rate, zero), (zero, zero, 2 * x * eps_rate))
    return p, eps, eps_rate, c, rate


@pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])
@pytest.mark.parametrize("fraction", [0.1, 0.5, 0.95])
@pytest.mark.parametrize("row", range(4))
def test_one_dimensional_law_is_given_back(row: int, fraction: float, locked: bool) -> None:
    with mp.workdps(40):
        p, eps, eps_rate, c, rate = compaction(row, locked, fraction)
        dt = mp.mpf("0.25")
        c0 = subtract(c, scale(dt, rate))
        root = build(lambda i, j: mp.sqrt(c[i][j]))
        sigma = scale(1 / determinant(root), congruence(root, piola_of(c0, c, dt, p, locked)))
        axial = sigma[2][2] - (0 if locked else sigma[1][1])
        expected = law_1d(eps, eps_rate, p, locked)
        assert expected < 0
        assert abs(axial / expected - 1) < mp.mpf("1e-25")


def test_one_dimensional_check_sees_an_error_in_one_coefficient() -> None:
    with mp.workdps(40):
        p, eps, eps_rate, c, rate = compaction(0, False, 0.5)
        viscous = viscous_stress(c, rate, mp.mpf(1), p, False)
        names = ((name, mp.mpf("1e-20") if name == "k" else 0) for name in PROPERTY_NAMES)
        wrong = Properties.of([getattr(p, name) * (1 + change) for name, change in names])
        axial = viscous[2][2] * c[2][2] - viscous[1][1] * c[1][1]
        assert abs(axial / law_1d(eps, eps_rate, wrong, False) - 1) > mp.mpf("1e-25")


def test_drawn_states_cover_what_they_promise() -> None:
    drawn = random_states(31, 60, locked=True)
    times = np.log10([state.time_increment for state in drawn])
    assert times.min() < -5 and times.max() > 2
    assert len({state.label.split(",")[0] for state in drawn}) == 4
    turns = [np.degrees(np.arccos((np.trace(polar(state.end)) - 1) / 2)) for state in drawn]
    assert min(turns) < 20 and max(turns) > 160
    again = random_states(31, 60, locked=True)
    for one, other in zip(drawn, again, strict=True):
        assert np.array_equal(one.end, other.end) and np.array_equal(one.props, other.props)


def polar(deformation: Any) -> Any:
    """Rotation of the polar decomposition."""
    left, _, right = np.linalg.svd(deformation)
    return left @ right
