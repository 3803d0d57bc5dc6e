"""The batch routine (NAME_batch.f90) gives every point what the scalar routine gives: results, faults, messages.

Stress and DDSDDE are compared relative to the largest component of the point, states and energies one by one, at 1e-13: the vector
functions of glibc differ from the scalar ones by up to 4 ulp, and exponents reach some tens.
"""

from __future__ import annotations

import ctypes
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from planting import Alteration, planted, replace
from plyflow.driver import points
from plyflow.driver.drive import UmatAddress
from plyflow.driver.points import BatchResult, call_points
from plyflow.umat import batch
from plyflow.umat.batch import BATCH_FLAGS, BatchRoutine
from plyflow.umat.compile import compile_batch, generate_batch_cached
from plyflow.umat.prepare import Umat, prepare_umat
from umatgen.pipeline import generate_batch
from umatgen.scene import SCENES, SceneError

Array = NDArray[np.float64]
QUICK = ("-O0", "-fPIC", "-frecursive")  # for what is derived; the default scene is compiled as it is for users
LOCK = -0.140253
BOUND = 1.0e-13


class InBlocks(UmatAddress):
    """A UMAT with a batch routine of the test's own."""

    batch_address = 0


def altered(umat: Umat, alteration: Alteration = lambda source: source) -> InBlocks:
    """The scalar routine of a scene with its batch routine altered and quickly compiled."""

    def build(source: str) -> InBlocks:
        loaded = ctypes.CDLL(str(compile_batch(source, QUICK, "any")))
        library = InBlocks(umat.library.address, umat.library.standin_address)
        routine = loaded[f"pfb_{umat.manifest['name']}_batch_"]
        object.__setattr__(library, "batch_address", ctypes.cast(routine, ctypes.c_void_p).value)
        return library

    found: InBlocks = planted(generate_batch_cached(SCENES[umat.manifest["name"]]), alteration, build)
    return found


def inputs(umat: Umat, n: int, seed: int = 3) -> dict[str, Any]:
    """Random states before, at and after the lock; increments of all sizes, some through the lock, some without rate or time."""
    generator = np.random.default_rng(seed)
    thick = np.exp(-generator.uniform(0.0, 0.4, n))
    start = np.zeros((n, 3, 3))
    start[:, [0, 1, 2], [0, 1, 2]] = np.stack([np.ones(n), np.minimum(1.0 / thick, np.exp(-LOCK)), thick], axis=1)
    start += 0.01 * generator.normal(size=(n, 3, 3))
    size = 10.0 ** generator.uniform(-7.0, -1.5, n)[:, None, None]
    end = start @ (np.eye(3) + size * (generator.normal(size=(n, 3, 3)) - np.diag([0.0, 0.0, 1.0])))
    end[::23] = start[::23]
    ntens = int(umat.manifest["ntens"])
    if ntens == 4:  # the fibre along axis 3, no shear out of the plane
        for matrix in (start, end):
            matrix[:] = matrix[:, [1, 2, 0]][:, :, [1, 2, 0]]
            matrix[:, [0, 1, 2, 2], [2, 2, 0, 1]] = 0.0
    names = [entry["name"] for entry in umat.manifest["statev"]]
    state = generator.random((n, len(names)))
    state[:, names.index("locked")] = thick < np.exp(LOCK)
    state[:, names.index("eps_rate")] *= -1e-3
    if "dt_last" in names:
        state[::5, names.index("dt_last")] = 0.0
    dt = 10.0 ** generator.uniform(-4.0, 2.0, n)
    dt[::29] = 0.0
    return {
        "props": np.array([entry["default"] for entry in umat.manifest["props"]]), "f0": start, "f1": end, "dt": dt, "statev": state,
        "stress": generator.normal(size=(n, ntens)), "energies": generator.random((n, 3)), "ntens": ntens, "increment": 2,
        "threads": 1,
    }  # fmt: skip


def part(given: dict[str, Any], chosen: Any) -> dict[str, Any]:
    """The same call for some of the points."""
    each = ("f0", "f1", "dt", "statev", "stress", "energies")
    return given | {name: given[name][chosen] for name in each}


def faults(found: BatchResult, wanted: BatchResult) -> list[str]:
    """What differs between a batch in blocks and one by one."""
    result = [] if found.messages == wanted.messages else ["messages"]
    result += [name for name in ("outcome", "pnewdt") if (getattr(found, name) != getattr(wanted, name)).any()]
    usable = wanted.outcome == "converged"
    for name in ("stress", "ddsdde"):
        one, other = (getattr(r, name)[usable].reshape(usable.sum(), -1) for r in (found, wanted))
        result += [name] if (np.abs(one - other).max(1) > BOUND * np.abs(other).max(1)).any() else []
    for name in ("statev", "energies"):
        one, other = (getattr(r, name)[usable] for r in (found, wanted))
        result += [name] if (np.abs(one - other) > BOUND * np.abs(other)).any() else []
    return result


@pytest.fixture(scope="module")
def default() -> Umat:
    return prepare_umat("default")


@pytest.fixture(autouse=True)
def few_points_are_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(points, "FEWEST_FOR_BLOCKS", 1)


@pytest.mark.parametrize("scene", ["bdf1", "plane"])
def test_every_point_is_within_1e_13_of_the_scalar_routine(scene: str) -> None:
    umat = prepare_umat(scene)
    given = inputs(umat, 1203)
    found, wanted = call_points(altered(umat), **given), call_points(umat.library, **given, blocks=False)
    assert faults(found, wanted) == []
    assert wanted.in_blocks == 0
    assert 1000 < found.in_blocks < 1203  # those through the lock, and those without a result, go one by one


def test_the_shipped_routine_is_within_1e_13_on_every_thread(default: Umat) -> None:
    given = inputs(default, 2005)
    found = [call_points(default.library, **{**given, "threads": n}) for n in (1, 2)]
    assert faults(found[0], call_points(default.library, **given, blocks=False)) == []
    assert found[0].in_blocks > 1800
    for name in ("stress", "ddsdde", "statev", "energies"):
        assert getattr(found[0], name).tobytes() == getattr(found[1], name).tobytes()


@pytest.mark.parametrize(
    ("lane", "error"),
    [(1, "stress(p,3) = stress(p,3)*merge(1.0d0 + 1.0d-12, 1.0d0, p == 1)"), (6, "margin(p) = merge(1.0d0, margin(p), p == 6)")],
    ids=["wrong in the twelfth digit", "fault overlooked"],
)
def test_an_error_in_one_lane_is_seen(bdf1: Umat, lane: int, error: str) -> None:
    given = inputs(bdf1, 80)
    given["f1"][lane - 1 :: 16, 2, 2] *= 0.4  # beyond the limit
    library = altered(bdf1, replace("sse(p) = energy(p)", f"{error}\n      sse(p) = energy(p)", once=True))
    assert faults(call_points(library, **given), call_points(bdf1.library, **given, blocks=False)) != []


def test_the_neighbours_and_the_size_of_a_batch_change_no_bit(default: Umat) -> None:
    given = inputs(default, 64)
    whole = call_points(default.library, **given)
    for chosen in (slice(0, 1), slice(3, 10), slice(8, 16), slice(1, 10), slice(20, 37), slice(None, None, -1)):
        some = call_points(default.library, **part(given, chosen))
        assert some.stress.tobytes() == whole.stress[chosen].tobytes()
        assert some.ddsdde.tobytes() == whole.ddsdde[chosen].tobytes()


def test_faults_and_messages_are_those_of_the_scalar_routine(default: Umat) -> None:
    given = inputs(default, 100)
    clean = call_points(default.library, **given)
    bad: list[Callable[[int], None]] = [
        lambda n: given["f1"][n].fill(np.nan), lambda n: given["f0"].__setitem__((n, 0, 0), np.inf),
        lambda n: given["f1"].__setitem__(n, np.diag([1.0, 1.0, 0.0])), lambda n: given["f1"].__setitem__(n, -np.eye(3)),
        lambda n: given["f1"].__setitem__((n, 2, 2), 0.3), lambda n: given["f0"].__setitem__(n, np.diag([1.0, 1.0, 0.01])),
        lambda n: given["dt"].__setitem__(n, -1.0), lambda n: given["dt"].__setitem__(n, np.nan),
        lambda n: given["f1"].__setitem__(n, 1e150 * np.eye(3)), lambda n: given["statev"].__setitem__((n, 7), np.nan),
    ]  # fmt: skip
    for place, spoil in enumerate(bad):
        spoil(9 * place + 1)
    found, wanted = call_points(default.library, **given), call_points(default.library, **given, blocks=False)
    assert faults(found, wanted) == []
    assert set(np.flatnonzero(wanted.outcome != "converged")) == {9 * place + 1 for place in range(len(bad))}
    assert len(wanted.messages) == len(bad) - 1  # a dissipation that is not a number is no fault of the law
    others = np.setdiff1d(np.arange(100), found.failed)
    assert found.ddsdde[others].tobytes() == clean.ddsdde[others].tobytes()


def test_constants_of_single_points_and_bad_ones_are_those_of_the_scalar_routine(default: Umat) -> None:
    given = inputs(default, 90)
    many = np.tile(given["props"], (90, 1))
    many[20:, 3] *= 1.01
    many[[5, 33, 34], 4] = 0.5, np.nan, -1.0
    found, wanted = (call_points(default.library, **{**given, "props": many}, blocks=b) for b in (True, False))
    assert faults(found, wanted) == []
    assert list(wanted.failed) == [5, 33, 34] and found.in_blocks > 70
    assert call_points(default.library, **{**given, "props": many[5]}).in_blocks == 0
    short = call_points(default.library, **{**given, "props": given["props"][:16]})
    assert short.in_blocks == 0 and (short.outcome == "stopped").all()


@pytest.mark.parametrize(("scene", "why"), [("printed", "compaction 'printed'"), ("table", "a temperature table")])
def test_scenes_without_a_batch_routine_say_so(scene: str, why: str) -> None:
    routine = BatchRoutine(SCENES[scene])
    assert routine.address == 0
    assert routine.says.startswith(why) and "points go one by one" in routine.says
    with pytest.raises(SceneError, match=why):
        generate_batch_cached(SCENES[scene])


def test_provenance_and_result_say_how_a_batch_was_done(default: Umat, monkeypatch: pytest.MonkeyPatch) -> None:
    assert default.provenance.batches == f"in blocks, {' '.join(BATCH_FLAGS)}"
    given = inputs(default, 20)
    monkeypatch.setattr(points, "FEWEST_FOR_BLOCKS", 64)
    assert call_points(default.library, **given).in_blocks == 0
    monkeypatch.setattr(batch, "BATCH_FLAGS", ("-no-such-flag",))
    refused = BatchRoutine(SCENES["default"])
    assert refused.address == 0 and "no-such-flag" in refused.says


def test_a_library_is_kept_for_each_cpu(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PLYFLOW_CACHE", str(tmp_path))
    source = "subroutine nothing\nend subroutine nothing\n"
    kept = [compile_batch(source, ("-fPIC",), cpu) for cpu in ("one", "two", "one")]
    assert kept[0] == kept[2] != kept[1]
    assert batch.cpu() == batch.cpu() != ""


def test_the_bytes_do_not_depend_on_the_process() -> None:
    program = "from umatgen.pipeline import *; from umatgen.scene import SCENES; print(generate_batch(SCENES['lean']), end='')"
    answer = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, env={**os.environ, "PYTHONHASHSEED": "4711"}
    )
    assert answer.stdout == generate_batch(SCENES["lean"])


@pytest.mark.parametrize("scene", ["default", "plane"])
def test_the_source_holds_no_shared_state_and_no_branch_inside_its_vector_loops(scene: str) -> None:
    source = generate_batch_cached(SCENES[scene])
    assert not re.search(r"^\s*(SAVE|COMMON|DATA|PRINT|WRITE|OPEN|READ)\b", source, re.M | re.I)
    assert max(map(len, source.splitlines())) <= 100
    loops = re.findall(r"^!\$omp simd.*?\n\s*(DO p = .*?)\n\s*END DO", source, re.S | re.M)
    assert len(loops) > 20
    assert not [loop for loop in loops if re.search(r"\bIF \(|\bCALL\b|\batanh\(", loop)]
