"""Increments without time, faults of arithmetic that compilers hide, and directions: what the kernel must answer or refuse."""

import ctypes
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from oracle import PROPERTY_NAMES, properties_of, random_states
from oracle.compare import relative_error, statev_at_start
from plyflow.umat.compile import FLAGS
from plyflow.umat.library import UmatLibrary
from umat.planted import compiled, drawn, emit
from umat.test_umat_refusals import BAD_DEFORMATIONS, IDENTITY, call
from umatgen.scene import SCENES, Scene

RATE = 6
FAST = (*FLAGS, "-O3", "-ffast-math")
BY_VALUE = "abs(number) <= huge(number)"
BY_BITS = "ibclr(bits(words), 63) <= largest(words)"


@pytest.mark.parametrize("regime", ["squeeze", "bleed"])
def test_an_increment_without_time_has_the_stress_at_rest_and_the_tangent_of_a_second(
    umat: UmatLibrary, regime: str
) -> None:
    """Elastic and constraint stress; a finite tangent, that of one second at the last rate, which stays in STATEV 7."""
    for state in drawn(regime, 70, 12):
        statev = statev_at_start(state.locked)
        statev[RATE] = -1e-3
        props = state.props.copy()
        props[PROPERTY_NAMES.index("strain_floor")] = props[PROPERTY_NAMES.index("rate_floor")] = 1e-12
        found = umat.call(state.start, state.end, 0.0, props, statev)
        rest = umat.call(state.end, state.end, 1.0, props, statev)
        assert not found.messages and not found.stopped
        assert relative_error(found.stress, rest.stress) <= 1e-15
        assert relative_error(found.ddsdde, rest.ddsdde) <= 1e-15
        assert (found.statev[RATE], rest.statev[RATE]) == (-1e-3, 0.0)
        assert found.scd == 0.0


def test_the_tangent_without_time_knows_the_last_rate(umat: UmatLibrary) -> None:
    """Its viscous part falls like rate**a; an emitted source that forgets the rate is seen."""
    props = properties_of(kappa=0.0, E_L=1e-60, E_T=1e-60, G_LT=1e-60)
    forgets = compiled(emit(), ("IF (j2_last > j2_eff) g_visc", "IF (j2_last < 0.0d0) g_visc"))
    stiffness = []
    for library, rate in ((umat, -1e-3), (umat, -1e-2), (forgets, -1e-3), (forgets, -1e-2)):
        statev = statev_at_start(False)
        statev[RATE] = rate
        stiffness.append(library.call(IDENTITY, IDENTITY, 0.0, props, statev).ddsdde[2, 2])
    a = props[PROPERTY_NAMES.index("a")]
    assert stiffness[1] / stiffness[0] == pytest.approx(10.0**a, rel=1e-9)
    assert stiffness[2] == stiffness[3] > 100 * stiffness[0]


def test_the_default_scene_answers_an_increment_without_time() -> None:
    creep = compiled(emit("default"))
    for state in random_states(71, 6, False):
        found = creep.call(state.start, state.end, 0.0, state.props, np.zeros(10))
        assert not found.messages
        assert np.isfinite(found.ddsdde).all()


@pytest.mark.parametrize("name", [name for name in BAD_DEFORMATIONS if "NaN" in name or name == "infinite"])
@pytest.mark.parametrize("at_start", [False, True])
def test_checks_survive_a_compiler_that_assumes_finite_numbers(name: str, at_start: bool) -> None:
    fast, bad = compiled(emit(), flags=FAST), BAD_DEFORMATIONS[name]
    result = call(fast, *((bad, IDENTITY) if at_start else (IDENTITY, bad)), False)
    assert result.stopped if at_start else result.pnewdt <= 0.25
    assert "is not finite" in result.messages
    assert not result.ddsdde.any()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_constants_and_time_are_checked_by_their_bits_too(value: float) -> None:
    fast = compiled(emit(), flags=FAST)
    assert call(fast, IDENTITY, IDENTITY, False, props=properties_of(b_squeeze=value)).stopped
    assert call(fast, IDENTITY, IDENTITY, False, dt=value).stopped


def test_a_check_by_value_does_not_survive_it() -> None:
    by_value = compiled(emit(), (BY_BITS, BY_VALUE), flags=FAST)
    assert not call(by_value, IDENTITY, IDENTITY, False, props=properties_of(b_squeeze=np.nan)).stopped


def raises_invalid(library: UmatLibrary, end: Any) -> bool:
    """Whether a call raises the flag of invalid operations: a root of a negative, nothing over nothing."""
    mathematics, invalid = ctypes.CDLL("libm.so.6"), 1
    mathematics.feclearexcept(invalid)
    call(library, IDENTITY, end, False)
    return bool(mathematics.fetestexcept(invalid))


@pytest.mark.parametrize("scene", ["bdf1", "printed", "paper"])
def test_no_invalid_operation_comes_before_the_check(scene: str) -> None:
    """Inverted, singular and of I1 and I3 without a root: -ffpe-trap=invalid would end the program there."""
    library = compiled(emit(scene))
    for end in (
        np.diag([1.0, 1.0, -1.0]),
        np.diag([1.0, 1.0, 0.0]),
        np.diag([0.5, 0.9, 0.95]),
        np.diag([1.5, 0.1, 0.9]),
    ):
        assert not raises_invalid(library, end), end


def test_a_root_of_a_negative_is_seen() -> None:
    root = ("eps = log(stretch)", "eps = sqrt(-stretch)")
    assert raises_invalid(compiled(emit("printed"), root), np.diag([1.0, 1.01, 0.99]))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("axes", [("1", "3"), ("1", "2"), ("2", "1"), ("3", "2")])
def test_free_directions_along_axes_are_the_axes(axes: tuple[str, str], turned: bool) -> None:
    """Whatever their length; the plies of the state are across the axis of the normal."""
    fixed = compiled(emit(replace(SCENES["bdf1"], name="fixed", fibre=axes[0], normal=axes[1])))
    free = compiled(emit(replace(SCENES["bdf1"], name="open", fibre="free", normal="free")))
    fibre, normal = (3.0 * np.eye(3)[int(axis) - 1] * (-1.0 if turned else 1.0) for axis in axes)
    order = np.argsort([int(axes[0]), 6 - int(axes[0]) - int(axes[1]), int(axes[1])])
    for state in random_states(72, 4, False, relative_rotation=False):
        ends = [f[np.ix_(order, order)] for f in (state.start, state.end)]
        one = fixed.call(*ends, state.time_increment, state.props, np.zeros(8))
        other = free.call(*ends, state.time_increment, [*state.props, *fibre, *normal], np.zeros(8))
        assert relative_error(other.stress, one.stress) < 1e-12
        assert relative_error(other.ddsdde, one.ddsdde) < 1e-12
        assert other.statev[:5] == pytest.approx(one.statev[:5], rel=1e-12)


@pytest.mark.parametrize("normal", [(2.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (1.0, 1e-8, 0.0), (0.0, 0.0, 0.0)])
def test_a_normal_along_the_fibre_is_refused(normal: tuple[float, ...]) -> None:
    free = compiled(emit("free"))
    state = [0.0] * 10
    result = free.call(IDENTITY, IDENTITY, 1.0, [*properties_of(), 1.0, 0.0, 0.0, *normal], state)
    assert result.stopped
    assert not result.stress.any() and not result.ddsdde.any()
    skew = free.call(IDENTITY, IDENTITY, 1.0, [*properties_of(), 1.0, 0.0, 0.0, 1.0, 1.0, 0.0], state)
    assert not skew.messages


@pytest.mark.parametrize(
    "flags",
    [("-ffixed-form", "-cpp", "-std=legacy", "-ffixed-line-length-132"), ("-ffixed-form", "-fdefault-integer-8"),
     ("-ffree-form", "-std=f2018", "-fdefault-integer-8"), ("-ffree-form", "-cpp")],
    ids=" ".join,
)  # fmt: skip
def test_preprocessors_and_long_integers_take_the_source(flags: tuple[str, ...], tmp_path: Path) -> None:
    """The ways of compiling that tests/abaqus does not run: only whether the compiler has anything to say."""
    (tmp_path / "umat.f").write_text(emit(Scene(form="free" if "-ffree-form" in flags else "fixed")))
    command = ["gfortran", *flags, "-Wall", "-Wextra", "-Werror", "-O2", "-c", "umat.f", "-o", "umat.o"]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (answer.returncode, answer.stderr) == (0, "")
