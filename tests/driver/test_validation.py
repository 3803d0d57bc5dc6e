"""Errors of a user are named before anything runs: the value, the bound, the remedy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from plyflow.driver.drive import Controls, DriverError, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"duration": 0.0}, "duration is 0.0 s; it must be positive"),
        ({"duration": float("nan")}, "must be positive and finite"),
        ({"targets": {"44": 1.0}}, "unknown component '44'"),
        ({"targets": {"33": 1.0}, "kinds": {"33": "Q"}}, "kind 'Q'; use 'F', 'S' or 'P'"),
        ({"kinds": {"22": "S"}}, "no target"),
        ({"targets": {"21": 1.0}, "kinds": {"21": "S"}}, "prescribe 12 instead"),
        ({"targets": {"12": 1.0}, "kinds": {"12": "P"}}, "is a shear"),
        ({"targets": {"33": float("inf")}}, "must be finite"),
    ],
)
def test_bad_steps(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(DriverError, match=message.replace("(", r"\(")):
        Step(**{"duration": 1.0, **arguments})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"initial_increment": -1.0}, "initial_increment is -1.0"),
        ({"cut": 1.5}, "cut is 1.5"),
        ({"residual_tolerance": 0.0}, "residual_tolerance is 0.0"),
        ({"max_iterations": 0}, "max_iterations is 0"),
        ({"newton": "bold"}, "newton is 'bold'; use one of power, plain"),
        ({"initial_increment": 1.0, "minimum_increment": 2.0}, "must not decrease"),
        ({"initial_increment": float("nan")}, "initial_increment is nan"),
    ],
)
def test_bad_controls(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(DriverError, match=message):
        Controls(**arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"steps": []}, "0 steps"),
        ({"props": [1.0, float("nan")]}, r"props\[1\] is not finite"),
        ({"n_statev": -1}, "n_statev is -1"),
        ({"statev": [1.0, 2.0]}, "statev has 2 values; 1 are needed"),
        ({"ntens": 3}, "ntens is 3"),
        ({"material_name": "x" * 81}, "81 characters"),
        ({"deformation_gradient": -np.eye(3)}, "det > 0"),
        ({"controls": Controls(constraint_release_statev=2)}, "constraint_release_statev is 2"),
        ({"steps": [Step(1.0, {"33": 0.5}), Step(1.0, {"33": 0.0})]}, "step 2 ends at det F = 0"),
        ({"steps": [Step(1.0, {"33": -1.0})]}, "step 1 ends at det F = -1"),
        ({"library": UmatAddress(0)}, "address is 0"),
    ],
)
def test_bad_calls(umat: Umat, arguments: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {
        "library": umat("neo_hooke"),
        "props": [1.0, 2.0],
        "n_statev": 1,
        "steps": [Step(1.0, {"33": 0.9})],
    }
    assert drive(**good).completed
    with pytest.raises(DriverError, match=message):
        drive(**{**good, **arguments})


def test_driver_errors_are_value_errors() -> None:
    assert issubclass(DriverError, ValueError)


def test_an_inverted_f_on_the_way_fails_with_a_message(umat: Umat) -> None:
    """With a free component the driver cannot know the end before it runs."""
    through = Step(1.0, {"11": -0.5, "22": 0.0}, {"22": "S"})
    history = drive(umat("neo_hooke"), [1.0, 2.0], 1, [through], Controls(0.1, 0.01))
    assert not history.completed
    assert "det F not positive" in history.message
    assert (np.linalg.det(history.deformation_gradient) > 0).all()
