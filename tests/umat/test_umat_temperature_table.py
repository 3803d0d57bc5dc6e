"""The temperature table: the same k, a, b as in Python, the same answer as with PROPS, DDSDDT, and what is refused."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from oracle import PROPERTY_NAMES, random_states
from plyflow.case.assumptions import assumed_lock
from plyflow.case.case import Case
from plyflow.case.materials import find_material
from plyflow.errors import InputError
from plyflow.run.case_run import run_case
from plyflow.umat.library import CallResult, UmatLibrary
from plyflow.umat.prepare import prepare_umat
from plyflow.umat.scenes import read_scene
from umat.planted import compiled, emit
from umatgen.scene import SCENES, TABLE_COLUMNS, Scene, SceneError

NAMES = ("k", "a", "b_squeeze", "b_bleed")
TEMPERATURES = [30.0, 30.0001, 37.3, 40.0, 55.0, 69.999999, 70.0, 84.2, 90.0]


@pytest.fixture(scope="module")
def table() -> UmatLibrary:
    return compiled(emit("table"))


def interpolated(library: UmatLibrary, temperature: float) -> tuple[list[float], list[float]]:
    """k, a, b_squeeze, b_bleed and their slopes by the emitted procedure itself."""
    values = [ctypes.c_double() for _ in range(8)]
    procedure = ctypes.CDLL(str(library.path)).pf_table_temperature_
    procedure(ctypes.byref(ctypes.c_double(temperature)), *(ctypes.byref(v) for v in values))
    numbers = [v.value for v in values]
    return numbers[:4], numbers[4:]


def states(count: int = 6) -> list[Any]:
    return [state for locked in (False, True) for state in random_states(3, count, locked)]


def answer(
    library: UmatLibrary, state: Any, temperature: float, step: float = 0.0, eps_lock: float | None = None
) -> CallResult:
    kept = [i for i, name in enumerate(PROPERTY_NAMES) if name not in NAMES]
    statev = np.zeros(8)
    statev[4] = float(state.locked)
    props = np.array(state.props, dtype=float)
    if eps_lock is not None:
        props[PROPERTY_NAMES.index("eps_lock")] = eps_lock
    return library.call(
        state.start, state.end, state.time_increment, props[kept], statev,
        temperature=temperature, temperature_increment=step,
    )  # fmt: skip


@pytest.mark.parametrize("temperature", TEMPERATURES)
def test_fortran_and_python_interpolate_alike(table: UmatLibrary, temperature: float) -> None:
    material = find_material("IM7-8552")
    values, slopes = interpolated(table, temperature)
    np.testing.assert_allclose(values, [getattr(material.at(temperature), name) for name in NAMES], rtol=1e-12)
    if 30.0 < temperature < 90.0:
        step = 1e-4
        ahead, behind = (interpolated(table, temperature + h)[0] for h in (step, -step))
        np.testing.assert_allclose(slopes, (np.array(ahead) - behind) / (2 * step), rtol=1e-3, atol=1e-6)


def test_a_planted_coefficient_is_seen() -> None:
    found = interpolated(compiled(emit("table"), ("0.86d0", "0.87d0")), 55.0)[0]
    assert abs(found[0] - find_material("IM7-8552").at(55.0).k) > 1e-3


def test_with_the_same_constants_in_props_the_answer_is_the_same(table: UmatLibrary, umat: UmatLibrary) -> None:
    """TEMP at the start is 3 degrees lower: what counts is TEMP + DTEMP."""
    for state, temperature in zip(states(), 2 * TEMPERATURES[2:8], strict=True):
        props = np.array(state.props, dtype=float)
        for name in NAMES:
            props[PROPERTY_NAMES.index(name)] = getattr(find_material("IM7-8552").at(temperature), name)
        statev = np.zeros(8)
        statev[4] = float(state.locked)
        expected = umat.call(state.start, state.end, state.time_increment, props, statev)
        found = answer(table, state, temperature - 3.0, 3.0)
        if expected.messages:
            assert found.messages
            continue
        scale = np.abs(expected.stress).max()
        np.testing.assert_allclose(found.stress, expected.stress, rtol=0, atol=1e-12 * scale)
        np.testing.assert_allclose(found.ddsdde, expected.ddsdde, rtol=0, atol=1e-12 * np.abs(expected.ddsdde).max())


def ddsddt_errors(library: UmatLibrary) -> list[float]:
    """Differences of DDSDDT from central differences over temperature, extrapolated once, per largest component."""
    errors = []
    for state in states(4):
        found = answer(library, state, 57.0)
        if found.messages:
            continue
        slopes = []
        for h in (2e-2, 1e-2):
            ahead, behind = (answer(library, state, 57.0 + s).stress for s in (h, -h))
            slopes.append((ahead - behind) / (2 * h))
        exact = (4 * slopes[1] - slopes[0]) / 3
        noise = 1e-16 * np.abs(found.stress).max() / 1e-2
        errors.append(float(np.abs(found.ddsddt - exact).max() / (np.abs(exact).max() + 1e6 * noise)))
    return errors


def test_ddsddt_is_the_derivative_of_the_stress(table: UmatLibrary) -> None:
    errors = ddsddt_errors(table)
    assert len(errors) >= 4
    assert max(errors) < 1e-6


def test_a_planted_slope_is_seen_in_ddsddt() -> None:
    assert max(ddsddt_errors(compiled(emit("table"), ("da_rate*dlng_a_rate", "dlng_a_rate/da_rate")))) > 1e-3


def lock_of(state: Any, temperature: float) -> float:
    """eps_lock of the ply of a state by the k of a temperature, in Python."""
    w0, h0 = (float(state.props[PROPERTY_NAMES.index(name)]) for name in ("w0", "h0"))
    return assumed_lock({}, find_material("IM7-8552").at(temperature).k, h0, w0)


def errors_of_the_lock(library: UmatLibrary) -> list[float]:
    """Relative differences of the stress with eps_lock = 0 to that with the eps_lock that Python gives the temperature."""
    errors = []
    for state in states(5):
        for temperature in TEMPERATURES:
            found, wanted = (answer(library, state, temperature, 0.0, lock) for lock in (0.0, lock_of(state, temperature)))
            if found.messages or wanted.messages:
                assert bool(found.messages) == bool(wanted.messages)
                continue
            errors.append(float(np.abs(found.stress - wanted.stress).max() / np.abs(wanted.stress).max()))
    return errors


def test_eps_lock_zero_follows_the_k_of_the_temperature(table: UmatLibrary) -> None:
    """By Eqs. A.1 and 6 in the source, as in Python: to the rounding of a power of up to 22."""
    errors = errors_of_the_lock(table)
    assert len(errors) > 50
    assert max(errors) < 1e-11


def test_a_planted_digit_of_the_lock_is_seen() -> None:
    assert max(errors_of_the_lock(compiled(emit("table"), ("eps_lock = -0.5d0*log", "eps_lock = -0.501d0*log")))) > 1e-6


def test_ddsddt_follows_the_lock(table: UmatLibrary) -> None:
    """At 57 degC, where eps_lock moves with k, against central differences extrapolated once."""
    seen = 0
    for state in states(6):
        found = answer(table, state, 57.0, 0.0, 0.0)
        if found.messages:
            continue
        slopes = []
        for h in (2e-2, 1e-2):
            ahead, behind = (answer(table, state, 57.0 + s, 0.0, 0.0).stress for s in (h, -h))
            slopes.append((ahead - behind) / (2 * h))
        exact = (4 * slopes[1] - slopes[0]) / 3
        noise = 1e-16 * np.abs(found.stress).max() / 1e-2
        assert np.abs(found.ddsddt - exact).max() < 1e-6 * (np.abs(exact).max() + 1e6 * noise)
        constant = answer(table, state, 57.0, 0.0, lock_of(state, 57.0))
        seen += float(np.abs(found.ddsddt - constant.ddsddt).max()) > 1e-3 * float(np.abs(constant.ddsddt).max())
    assert seen >= 4


def test_other_scenes_leave_ddsddt_alone(umat: UmatLibrary) -> None:
    state = states(1)[0]
    result = umat.call(state.start, state.end, state.time_increment, state.props, np.zeros(8))
    assert not result.ddsddt.any()


@pytest.mark.parametrize(
    ("temperature", "bound"), [(29.9, "3.000000E+01"), (90.1, "9.000000E+01"), (float("nan"), "9.0")]
)
def test_outside_the_table_the_analysis_ends(table: UmatLibrary, temperature: float, bound: str) -> None:
    result = answer(table, states(1)[0], temperature)
    assert result.stopped
    assert "TEMP + DTEMP lies outside the temperature table of this scene" in result.messages
    assert f"bound {bound}" in result.messages


@pytest.mark.parametrize("end", [30.0, 90.0])
def test_the_ends_of_the_table_may_be_missed_by_rounding(table: UmatLibrary, end: float) -> None:
    """A ramp to the last temperature of the table arrives there but for the last digits of TEMP + DTEMP."""
    state = states(1)[0]
    expected = answer(table, state, end)
    for off in (-1e-12, 1e-12):
        found = answer(table, state, end - 0.1, 0.1 + off)
        assert not found.messages
        np.testing.assert_allclose(found.stress, expected.stress, rtol=1e-9)
    assert answer(table, state, end + np.sign(end - 60.0) * 1e-5).stopped


def test_a_case_of_the_programme_is_that_of_the_default_scene() -> None:
    case = Case("IM7-8552", 55.0, "BP", 15.0)
    one, other = (run_case(case, prepare_umat(name)) for name in ("bdf1", "table"))
    assert other.thickness_ratio[-1] == pytest.approx(one.thickness_ratio[-1], abs=1e-9)
    with pytest.raises(InputError, match=r"k = 0\.8\d* at 55 degC in its temperature table"):
        run_case(Case("IMA-M21", 55.0, "BP", 15.0), prepare_umat("table"))


def test_a_scene_file_names_a_material(tmp_path: Path) -> None:
    file = tmp_path / "ima.toml"
    file.write_text('integrator = "bdf1"\ntable = "IMA-M21"\n')
    scene = read_scene(file)
    assert dict(scene.table)["k"] == tuple(find_material("IMA-M21").table.k)
    run_case(Case("IMA-M21", 55.0, "BP", 15.0), prepare_umat(str(file)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("table = 3", "table must name a material"),
        ("[table]\ntemperature = [30, 40]\nk = [0.9, 0.8]", "it takes temperature, k, a, b_squeeze, b_bleed"),
        ('table = "unobtainium"', "unobtainium"),
        ('[table]\ntemperature = [30, "x"]\n', "'x', which is no number"),
    ],
)
def test_a_bad_table_in_a_scene_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        read_scene(file)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"temperature": (30.0, 30.0)}, "must rise"),
        ({"a": (-1.0, -0.9)}, r"a = -1 must lie in \(-1, 0\]"),
        ({"k": (0.9,)}, "k has 1 values for 2 temperatures"),
        ({"b_bleed": (-30.0, float("inf"))}, "not finite"),
    ],
)
def test_a_bad_table_is_refused(change: dict[str, tuple[float, ...]], message: str) -> None:
    columns = dict(
        zip(TABLE_COLUMNS, ((30.0, 40.0), (0.9, 0.8), (-0.9, -0.8), (-15.0, -16.0), (-30.0, -31.0)), strict=True)
    )
    Scene(name="mine", integrator="bdf1", table=tuple(columns.items()))
    with pytest.raises(SceneError, match=message):
        Scene(name="mine", integrator="bdf1", table=tuple((columns | change).items()))


@pytest.mark.parametrize(
    "field", [{"integrator": "creep"}, {"tangent": "none"}, {"compaction": "printed"}, {"baked": SCENES["baked"].baked}]
)
def test_what_does_not_go_with_a_table_is_refused(field: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match="a temperature table does not go with"):
        replace(SCENES["table"], **field)
