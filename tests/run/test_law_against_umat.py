"""The one-dimensional law against the UMAT driven with the exact multiplier of incompressibility."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from plyflow.case.case import Case, driver_steps, law_parameters, property_values, props_vector, state_place
from plyflow.driver.drive import drive
from plyflow.law import LawParameters, integrate
from plyflow.run.case_run import case_controls
from plyflow.umat.prepare import Umat

CASES = [
    Case("IM7-8552", 70.0, "CP", 30.0),
    Case("IMA-M21", 60.0, "BP", 15.0),
    Case("IM7-8552", 30.0, "SB", 15.0),
    Case("IM7-8552", 50.0, "CP", 30.0, "monotonic"),
]


def end_errors(case: Case, umat: Umat, refinement: float, law: LawParameters | None = None) -> tuple[float, float]:
    """Errors of the final thickness and width ratios without a penalty."""
    exact = replace(case, settings={"kappa": 0.0})
    values, load = property_values(exact, umat.manifest), exact.load_programme
    release = state_place(umat.manifest, "locked") + 1
    controls = replace(case_controls(refinement), incompressible=True, constraint_release_statev=release)
    history = drive(
        umat.library,
        np.array(props_vector(values, umat.manifest)),
        len(umat.manifest["statev"]),
        driver_steps(load),
        controls,
        temperature=case.temperature,
    )
    assert history.completed, history.message
    solution = integrate(law or law_parameters(values), load, [load.end])
    gradient = history.deformation_gradient[-1]
    return float(gradient[2, 2] - solution.thickness_ratio[0]), float(gradient[1, 1] - solution.width_ratio[0])


def check_first_order(errors: list[float]) -> None:
    """Halving every increment halves the error."""
    for coarse, fine in itertools.pairwise(errors):
        assert 1.85 < coarse / fine < 2.15, errors


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.label.replace(" ", "_"))
def test_the_umat_with_the_exact_multiplier_tends_to_the_law_at_first_order(case: Case, bdf1: Umat) -> None:
    errors = [end_errors(case, bdf1, refinement) for refinement in (2.0, 4.0, 8.0, 16.0)]
    check_first_order([thickness for thickness, _ in errors])
    assert abs(errors[-1][0]) < 5e-5
    assert max(abs(width) for _, width in errors) < 2e-5  # the landing tolerance at the lock


def test_a_law_with_another_k_is_noticed(bdf1: Umat) -> None:
    case = CASES[1]
    values = property_values(case, bdf1.manifest)
    other = law_parameters(values | {"k": values["k"] * 1.0001})
    with pytest.raises(AssertionError):
        check_first_order([end_errors(case, bdf1, refinement, other)[0] for refinement in (2.0, 4.0, 8.0, 16.0)])
