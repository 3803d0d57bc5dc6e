"""gamma_lock by Eq. A.1 read with arctan, what follows for width and thickness, and what a longer fibre would change."""

from __future__ import annotations

import math

import numpy as np
import pytest

from plyflow.case.assumptions import default_assumptions
from plyflow.case.case import Case
from plyflow.case.fibre_length import length_table
from plyflow.case.materials import known_materials
from plyflow.errors import InputError
from plyflow.law import edge_shear, integrate, lock_strain

# gamma_lock [deg] for 30 to 90 degC by Eq. A.1 read with arctan, worked out by hand.
EDGE_SHEAR = {
    "IM7-8552": (74.8, 79.8, 83.1, 84.8, 86.1, 86.6, 86.9),
    "IMA-M21": (70.4, 80.0, 85.2, 86.4, 86.7, 86.9, 87.1),
}
WIDTHS = {"BP": (1.040, 1.060, 1.088, 1.115, 1.151, 1.162, 1.162), "CP": (1.010, 1.015, 1.023, 1.030, 1.040, 1.046, 1.050)}
THICKNESS_BP = (0.760, 0.722, 0.688, 0.657, 0.622, 0.605, 0.595)


@pytest.mark.parametrize("name", EDGE_SHEAR)
def test_equation_a1_gives_the_edge_shear_of_each_column(name: str) -> None:
    found = [edge_shear(k, 0.5) for k in known_materials()[name].table.k]
    assert found == pytest.approx(EDGE_SHEAR[name], abs=0.05)
    ends = f"{min(found):.1f} to {max(found):.1f} deg"
    assert ends in default_assumptions()["gamma_lock"].reason  # what the declared assumption says of both materials
    with pytest.raises(AssertionError):  # another fraction is noticed
        assert [edge_shear(k, 0.51) for k in known_materials()[name].table.k] == pytest.approx(EDGE_SHEAR[name], abs=0.05)


def test_widths_rise_with_temperature_and_level_off() -> None:
    for layup, widths in WIDTHS.items():
        cases = [Case("IM7-8552", temperature, layup, 15.0) for temperature in known_materials()["IM7-8552"].table.temperature]
        ends = [integrate(case.law(), case.load_programme, [case.load_programme.end]) for case in cases]
        assert [float(end.width_ratio[0]) for end in ends] == pytest.approx(widths, abs=5.1e-4)
        if layup == "BP":
            assert [float(end.thickness_ratio[0]) for end in ends] == pytest.approx(THICKNESS_BP, abs=5.1e-4)


def printed_argument(k: float, fibre_fraction: float) -> float:
    """What Eq. A.1 takes the arcsine of, as printed, with d = 2 and d^2/(4 Af)."""
    radius, diameter = 1.0, 2.0
    a0, af = (math.pi * radius**2 / (2.0 * fraction) for fraction in (fibre_fraction, k**2))
    alpha = math.asin(a0 / af * math.sin(a0 / (a0 + af) * math.atan(diameter**2 / (4.0 * af))))
    return (4.0 * a0 / diameter**2 - math.sin(2.0 * alpha)) / (1.0 - math.cos(2.0 * alpha))


def test_the_printed_arcsine_has_no_solution_and_its_argument_is_the_tangent() -> None:
    assert printed_argument(0.813, 0.5) == pytest.approx(14.57, abs=0.005)
    for k in np.linspace(0.6, 1.05, 18):
        argument = printed_argument(float(k), 0.5)
        assert argument > 1.0
        assert math.tan(math.radians(edge_shear(float(k), 0.5))) == pytest.approx(argument, rel=1e-12)


def test_a_cell_without_contact_has_no_edge_shear_and_a_small_k_is_near_a_right_angle() -> None:
    with pytest.raises(InputError, match=r"Eq. A.1 gives no gamma_lock for k = 1.1 .* lower k, or set gamma_lock or eps_lock"):
        edge_shear(1.1, 0.5)
    assert lock_strain(0.5, 15.0, edge_shear(1e-3, 0.5), -0.2258) == pytest.approx(2.0 / 3.0 * -0.2258, rel=1e-14)


# Ends h/h0 of the scale-up specimen at 70 degC: l0 the same for both widths, l0 in proportion to the width.
LENGTHS = {
    80.0: {"CP": (0.866, 0.987), "BP": (0.714, 0.765)},
    None: {"CP": (0.860, 0.977), "SB": (0.760, 0.850), "BP": (0.688, 0.740)},
}


@pytest.mark.parametrize("angle", LENGTHS)
def test_a_longer_fibre_would_end_elsewhere(angle: float | None) -> None:
    table = length_table(**({} if angle is None else {"gamma_lock": angle})).set_index("layup")
    for layup, ends in LENGTHS[angle].items():
        assert table.loc[layup].to_numpy() == pytest.approx(ends, abs=5.1e-4)
