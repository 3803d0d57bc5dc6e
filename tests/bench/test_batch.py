"""The batch entry gives every point what a single call gives, on any number of threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.driver.points import BatchResult, available_threads, call_points
from plyflow.errors import InputError
from plyflow.umat.library import CallResult
from plyflow.umat.prepare import Umat, prepare_umat

Array = NDArray[np.float64]
POINTS = 60
FIELDS = ("stress", "ddsdde", "statev", "pnewdt")
THREADS = pytest.mark.parametrize("threads", [1, 2])


@pytest.fixture(scope="module")
def default() -> Umat:
    return prepare_umat("default")


def inputs(umat: Umat, points: int = POINTS) -> dict[str, Any]:
    """Points on both sides of the lock, with time increments over four decades and a stress of their own."""
    generator = np.random.default_rng(5)
    start = np.diag([1.001, 1.02, 0.98]) + 0.003 * generator.normal(size=(points, 3, 3))
    end = start + 0.002 * generator.normal(size=(points, 3, 3))
    ntens = int(umat.manifest["ntens"])
    if ntens == 4:  # the fibre along axis 3, no shear out of the plane
        for matrix in (start, end):
            matrix[:] = matrix[:, [1, 2, 0]][:, :, [1, 2, 0]]
            matrix[:, [0, 1, 2, 2], [2, 2, 0, 1]] = 0.0
    state = np.zeros((points, len(umat.manifest["statev"])))
    state[::2, [entry["name"] for entry in umat.manifest["statev"]].index("locked")] = 1.0
    return {
        "props": np.array([entry["default"] for entry in umat.manifest["props"]]),
        "f0": start,
        "f1": end,
        "dt": 10.0 ** generator.uniform(-3, 1, points),
        "statev": state,
        "stress": generator.normal(size=(points, ntens)),
        "ntens": ntens,
    }


def single(umat: Umat, given: dict[str, Any], point: int) -> CallResult:
    """The same point by itself."""
    own = (given[name][point] for name in ("f0", "f1", "dt"))
    return umat.library.call(*own, given["props"], given["statev"][point], given["stress"][point], ntens=given["ntens"])


def differences(umat: Umat, given: dict[str, Any], result: BatchResult) -> list[tuple[int, str]]:
    """Points and fields that are not bit for bit those of single calls."""
    found = []
    for point in range(len(given["f0"])):
        alone = single(umat, given, point)
        pairs = {name: (getattr(alone, name), getattr(result, name)[point]) for name in FIELDS}
        pairs["energies"] = ([alone.sse, alone.spd, alone.scd], result.energies[point])
        found += [(point, name) for name, (one, other) in pairs.items() if np.asarray(one).tobytes() != other.tobytes()]
    return found


@THREADS
@pytest.mark.parametrize("scene", ["default", "augmented", "plane", "baked"])
def test_every_point_is_bit_for_bit_a_single_call(scene: str, threads: int) -> None:
    umat = prepare_umat(scene)
    given = inputs(umat)
    result = call_points(umat.library, **given, threads=threads)
    assert differences(umat, given, result) == []
    assert set(result.outcome) <= {"converged", "pnewdt"} and result.messages == {}
    result.stress[7, 0] = np.nextafter(result.stress[7, 0], 1.0)
    assert differences(umat, given, result) == [(7, "stress")]


def test_threads_do_not_change_a_bit_of_many_points(default: Umat) -> None:
    assert available_threads() >= 1
    one, two = (call_points(default.library, **inputs(default, 5000), threads=n) for n in (1, 2))
    assert all(getattr(one, name).tobytes() == getattr(two, name).tobytes() for name in (*FIELDS, "energies"))


@THREADS
def test_failed_points_are_told_one_by_one_and_the_others_are_not_touched(default: Umat, threads: int) -> None:
    given = inputs(default)
    clean = call_points(default.library, **given, threads=threads)
    given["f1"][3], given["f1"][41] = -np.eye(3), np.full((3, 3), np.nan)
    given["f0"][59] = np.diag([1.0, 1.0, 0.01])
    result = call_points(default.library, **given, threads=threads)
    assert list(result.failed) == sorted({3, 41, 59, *clean.failed})
    assert [result.outcome[n] for n in (3, 41, 59)] == ["inverted", "inverted", "stopped"]
    assert set(result.messages) == {3, 41, 59}
    assert "J at the end" in result.messages[3] and "element 4" in result.messages[3]
    assert "not finite" in result.messages[41] and "compaction limit" in result.messages[59]
    others = [n for n in range(POINTS) if n not in (3, 41, 59)]
    assert result.stress[others].tobytes() == clean.stress[others].tobytes()


def test_constants_and_temperature_can_differ_from_point_to_point(default: Umat) -> None:
    given = inputs(default)
    many = np.tile(given["props"], (POINTS, 1))
    many[1::2, 3] *= 1.01
    result = call_points(default.library, **{**given, "props": many, "temperature": np.linspace(30, 90, POINTS)})
    for point in (0, 1, 17):
        assert result.stress[point].tobytes() == single(default, {**given, "props": many[point]}, point).stress.tobytes()
    assert differences(default, given, result) != []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"f0": np.eye(3)}, r"f0 has shape \(3, 3\)"),
        ({"f1": np.zeros((2, 3, 3))}, "f0 has 60 points, f1 2"),
        ({"statev": np.zeros((3, 8))}, r"statev has shape \(3, 8\)"),
        ({"stress": np.zeros((60, 4))}, r"stress has shape \(60, 4\)"),
        ({"dt": np.zeros(4)}, r"dt has shape \(4,\)"),
        ({"props": np.zeros((4, 17))}, r"props has shape \(4, 17\)"),
        ({"threads": 0}, "threads is 0"),
        ({"ntens": 3, "stress": None}, "ntens is 3"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(default: Umat, change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        call_points(default.library, **{**inputs(default), **change})


def test_arrays_of_an_earlier_result_are_written_anew_and_its_state_goes_on(default: Umat) -> None:
    given = inputs(default)
    first = call_points(default.library, **given)
    places = [getattr(first, name).__array_interface__["data"] for name in ("stress", "ddsdde", "statev", "outcome")]
    given |= {"f0": given["f1"], "f1": 1.001 * given["f1"], "stress": first.stress.copy(), "statev": first.statev.copy()}
    again = call_points(default.library, **{**given, "stress": first.stress, "statev": first.statev}, out=first)
    assert differences(default, given, again) == []
    assert [getattr(again, name).__array_interface__["data"] for name in ("stress", "ddsdde", "statev", "outcome")] == places
    with pytest.raises(InputError, match=r"out has stress \(60, 6\)"):
        call_points(default.library, **inputs(default, 59), out=first)
