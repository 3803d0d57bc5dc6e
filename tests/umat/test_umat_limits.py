"""Where the answer is known in closed form: the state F = I, and the one-dimensional law (Eq. 1)."""

import numpy as np
import pytest
from mpmath import mp

from oracle import Properties, ddsdde, law_1d, properties_of
from oracle.compare import Array, statev_at_start
from oracle.paper_tables import ROWS
from oracle.properties import normal_compliance
from plyflow.umat.library import UmatLibrary

IDENTITY = np.eye(3)
AT_REST = 1.0e30
"""A time increment in s over which the flow carries nothing."""
ELASTICITIES = {
    "table 4": {},
    "carbon": {"E_L": 1.3e5, "E_T": 9.0e3, "nu_LT": 0.3, "nu_TT": 0.45, "G_LT": 4.8e3},
    "soft": {"E_L": 40.0, "E_T": 2.0, "nu_LT": 0.25, "nu_TT": 0.3, "G_LT": 7.0},
}
each_elasticity = pytest.mark.parametrize("elasticity", ELASTICITIES.values(), ids=ELASTICITIES.keys())
each_regime = pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])


def inverse_compliance(props: Array) -> Array:
    """Stiffness of the transversely isotropic compliance, (6, 6), MPa."""
    with mp.workdps(40):
        p = Properties.of(props)
        normal = mp.matrix([list(row) for row in normal_compliance(p)]) ** -1
        stiffness = np.zeros((6, 6))
        stiffness[:3, :3] = [[float(normal[i, j]) for j in range(3)] for i in range(3)]
        stiffness[[3, 4, 5], [3, 4, 5]] = [float(g) for g in (p.G_LT, p.G_LT, p.E_T / (2 * (1 + p.nu_TT)))]
        return stiffness


@each_elasticity
@each_regime
@pytest.mark.parametrize("dt", [1.0e-6, 1.0, 1.0e3])
def test_undeformed_state_is_stress_free(
    umat: UmatLibrary, elasticity: dict[str, float], locked: bool, dt: float
) -> None:
    props = properties_of(**elasticity)
    found = umat.call(IDENTITY, IDENTITY, dt, props, statev_at_start(locked))
    largest_modulus = np.max(inverse_compliance(props))
    assert np.max(np.abs(found.stress)) <= 4 * np.finfo(float).eps * largest_modulus
    assert abs(found.sse) <= 4 * np.finfo(float).eps * largest_modulus
    assert found.scd == 0.0


@each_elasticity
@each_regime
def test_stiffness_at_rest_is_the_inverse_of_the_compliance(
    umat: UmatLibrary, elasticity: dict[str, float], locked: bool
) -> None:
    """All 36 components, each relative to itself where it is not zero."""
    props = properties_of(**elasticity, kappa=0.0)
    found = umat.call(IDENTITY, IDENTITY, AT_REST, props, statev_at_start(locked)).ddsdde
    wanted = inverse_compliance(props)
    present = wanted != 0
    assert np.max(np.abs(found[present] / wanted[present] - 1)) < 1e-12
    assert np.max(np.abs(found[~present])) <= 1e-16 * np.max(wanted)


def test_stiffness_check_sees_another_poisson_ratio(umat: UmatLibrary) -> None:
    props = properties_of(**ELASTICITIES["soft"], kappa=0.0)
    found = umat.call(IDENTITY, IDENTITY, AT_REST, props, statev_at_start(True)).ddsdde
    other = inverse_compliance(properties_of(**(ELASTICITIES["soft"] | {"nu_TT": 0.3 + 1e-9}), kappa=0.0))
    assert abs(found[1, 2] / other[1, 2] - 1) > 1e-12


@each_regime
def test_tangent_at_the_undeformed_state_is_the_mean_over_the_coincident_stretches(
    umat: UmatLibrary, locked: bool
) -> None:
    """The end at F = I from a sheared and stretched start: dx/dC has no direction there."""
    start = IDENTITY + np.array([[0.01, 0.02, 0.0], [0.0, 0.03, -0.02], [0.01, 0.0, 0.02]])
    props = properties_of(**ELASTICITIES["soft"])
    found = umat.call(start, IDENTITY, 0.5, props, statev_at_start(locked)).ddsdde
    wanted = np.array([[float(v) for v in row] for row in ddsdde(start, IDENTITY, 0.5, props, locked)])
    assert np.max(np.abs(found - wanted)) < 1e-12 * np.max(np.abs(wanted))


def compaction(props: Array, locked: bool, fraction: float) -> tuple[Array, Array, float, float]:
    """F0, F1, dt and the axial stress of Eq. 1, C11 = 1.

    Squeezing keeps the volume, bleeding the locked width; the fraction goes from no strain to the lock, or
    from the lock to the compaction limit. C0 = C1 - dt Cdot: the backward difference is the exact rate.
    """
    with mp.workdps(40):
        p, dt, rate = Properties.of(props), mp.mpf("0.25"), mp.mpf("-0.0625")
        lock, limit = p.eps_lock, mp.log(p.limit_stretch)
        eps = lock + fraction * (limit - lock) if locked else fraction * lock
        x = mp.exp(2 * eps)
        wide = (p.chi_l, p.chi_l) if locked else ((1 + 2 * rate * dt) / x, 1 / x)
        start, end = (
            np.diag([1.0, float(mp.sqrt(across)), float(mp.sqrt(along))])
            for across, along in zip(wide, (x * (1 - 2 * rate * dt), x), strict=True)
        )
        return start, end, float(dt), float(law_1d(eps, rate, p, locked))


@each_regime
@pytest.mark.parametrize("row", ROWS)
@pytest.mark.parametrize("fraction", [0.05, 0.5, 0.9])
def test_one_dimensional_law_is_given_back(
    umat: UmatLibrary, row: tuple[float, ...], fraction: float, locked: bool
) -> None:
    """sigma_33 - sigma_22 (free edge) in squeeze, sigma_33 in bleed, at all 14 columns of Tables 2 and 3.

    Elastic part, penalty and floors are taken down to nothing.
    """
    flow = dict(zip(("k", "a", "b_squeeze", "b_bleed"), row, strict=True))
    nothing = {"E_L": 1e-60, "E_T": 1e-60, "G_LT": 1e-60, "kappa": 0.0, "rate_floor": 1e-30, "strain_floor": 1e-30}
    props = properties_of(**flow, **nothing)
    start, end, dt, wanted = compaction(props, locked, fraction)
    found = umat.call(start, end, dt, props, statev_at_start(locked)).stress
    axial = found[2] - (0.0 if locked else found[1])
    assert wanted < 0
    assert abs(axial / wanted - 1) < 1e-12


def test_one_dimensional_check_sees_an_error_in_b(umat: UmatLibrary) -> None:
    props = properties_of(E_L=1e-60, E_T=1e-60, G_LT=1e-60, kappa=0.0, rate_floor=1e-30, strain_floor=1e-30)
    start, end, dt, wanted = compaction(props, True, 0.5)
    props[6] += 2e-12
    axial = umat.call(start, end, dt, props, statev_at_start(True)).stress[2]
    assert abs(axial / wanted - 1) > 1e-12
