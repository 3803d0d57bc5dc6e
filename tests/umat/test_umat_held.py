"""`after_lock = "held"`: stress, DDSDDE and energy against forty digits, and what it does to a specimen in the driver."""

from dataclasses import replace
from functools import cache
from typing import cast

import numpy as np
import pytest
from mpmath import mp

from oracle import PROPERTY_NAMES, Properties, State, properties_of
from oracle.algebra import right_cauchy_green, tensor
from oracle.compare import relative_error, statev_at_start, witness_ddsdde, witness_stress
from oracle.held import held_energy, held_stress, held_witness
from oracle.test_oracle_elastic import distance, gradient
from planting import replace as exchanged
from plyflow.case.case import Case, driver_steps, property_values, props_vector
from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.run.case_run import case_controls
from plyflow.umat.library import UmatLibrary
from umat.planted import DDSDDE_TOLERANCE, STRESS_TOLERANCE, compiled, drawn
from umatgen.pipeline import Generated, generate
from umatgen.scene import Scene, SceneError

HELD, FREE = (Scene(name=name, after_lock=name, integrator="bdf1") for name in ("held", "free"))
CREEP = Scene(name="heldcreep", after_lock="held")
LOCK, WIDEN = -0.0593, 1.003
KAPPA = PROPERTY_NAMES.index("kappa")


@cache
def made(scene: Scene) -> Generated:
    return generate(scene)


@cache
def library(scene: Scene = HELD) -> UmatLibrary:
    return compiled(made(scene).source)


def wide(regime: str, count: int, excess: float) -> list[State]:
    """Drawn increments whose end is made wider than at the lock by a strain of `excess`; kappa so that it is felt, not all."""
    states = []
    for state in drawn(regime, 21, count):
        names = dict(zip(PROPERTY_NAMES, state.props, strict=True))
        green = state.end.T @ state.end
        area = np.sqrt(green[0, 0] * green[1, 1] - green[0, 1] ** 2)
        stretch = np.diag([1.0, np.exp(excess - names["eps_lock"]) / area, 1.0])
        props = state.props.copy()
        props[KAPPA] = np.abs(witness_stress(state)).max() / max(excess, 1e-3)
        states.append(replace(state, start=state.start @ stretch, end=state.end @ stretch, props=props))
    return states


def errors(umat: UmatLibrary, state: State) -> tuple[float, float]:
    """Errors of stress and DDSDDE, relative to their largest entries."""
    answer = umat.call(state.start, state.end, state.time_increment, state.props, statev_at_start(state.locked))
    sigma, tangent, _ = held_witness(state)
    return (
        relative_error(answer.stress, witness_stress(state) + sigma),
        relative_error(answer.ddsdde, witness_ddsdde(state) + tangent),
    )


CASES = [("bleed", 1e-5), ("bleed", 1e-4), ("bleed", 1e-2), ("bleed", -1e-3), ("across", 1e-3)]


@pytest.mark.parametrize(("regime", "excess"), CASES)
def test_stress_and_ddsdde_match_forty_digits(regime: str, excess: float) -> None:
    """An excess of 1e-5 is itself rounded to 1e-11, and the force goes with its square; kappa keeps that below the stress."""
    for state in wide(regime, 4, excess):
        sigma, tangent = errors(library(), state)
        assert sigma <= STRESS_TOLERANCE
        assert tangent <= DDSDDE_TOLERANCE


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("c_plane = 10000.0d0*", "c_plane = 10000.1d0*"),
        ("half_plane(1) = -", "half_plane(1) = "),
        ("20000.0d0*cse_1*", "20002.0d0*cse_1*"),
    ],
)
def test_the_comparison_sees_a_planted_error(old: str, new: str) -> None:
    broken = compiled(exchanged(old, new)(made(HELD).source))
    worst = np.max([errors(broken, state) for state in wide("bleed", 4, 1e-2)], axis=0)
    assert worst[0] > STRESS_TOLERANCE or worst[1] > DDSDDE_TOLERANCE


def test_stress_is_twice_the_gradient_of_the_energy() -> None:
    with mp.workdps(90):
        for state in wide("bleed", 4, 1e-3):
            p, c = Properties.of(state.props), right_cauchy_green(tensor(state.end))
            assert distance(gradient(held_energy, c, p), held_stress(c, p)) < mp.mpf("1e-28")


def test_its_energy_is_in_sse_and_it_is_no_matter_before_the_lock() -> None:
    for regime, excess in (("bleed", 1e-2), ("squeeze", 1e-2)):
        for state in wide(regime, 4, excess):
            inputs = state.start, state.end, state.time_increment, state.props, statev_at_start(state.locked)
            with_it, without = library().call(*inputs), library(FREE).call(*inputs)
            bleeds = with_it.statev[4] == 1.0
            stored = held_witness(state)[2] if bleeds else 0.0
            assert with_it.sse - without.sse == pytest.approx(stored, rel=1e-9, abs=1e-12 * abs(without.sse))
            assert bleeds or with_it.stress.tobytes() == without.stress.tobytes()


def pressed(scene: Scene, layup: str) -> History:
    """The ramp-dwell programme of a case with a free edge."""
    case, manifest = Case("IM7-8552", temperature=70, layup=layup, width=15, load="ramp-dwell"), made(scene).manifest
    props = props_vector(property_values(case, manifest), manifest)
    states = cast("list[object]", manifest["statev"])
    history = drive(library(scene), props, len(states), driver_steps(case.load_programme), case_controls())
    assert history.completed, history.message
    return history


@pytest.mark.parametrize("layup", ["CP", "BP"])
def test_a_free_edge_ends_as_without_it(layup: str) -> None:
    """Nothing pushes a free edge outwards after the lock: it ends where it did, after a few increments more."""
    free, held = (pressed(scene, layup) for scene in (FREE, HELD))
    assert held.deformation_gradient[-1] == pytest.approx(free.deformation_gradient[-1], abs=1e-6)
    assert held.increments <= free.increments + 5


def widened(scene: Scene) -> float:
    """Width over that at the lock of a ply pressed past its lock and then pulled sideways by 0.2 MPa for 100 s."""
    pull = {"11": 1.0, "22": 0.2, "33": 0.2, "12": 0.0, "13": 0.0, "23": 0.0}
    kinds = {"22": "S", "33": "P"}
    steps = [Step(1.0, pull | {"22": 0.0}, kinds), Step(1.0, pull, kinds), Step(100.0, pull, kinds)]
    n_statev = 8 if scene.integrator == "bdf1" else 10
    history = drive(library(scene), properties_of(kappa=1e3), n_statev, steps, Controls(0.05, 1e-9, 10.0))
    assert history.completed, history.message
    assert history.statev[-1, 4] == 1.0
    return float(history.statev[-1, 1] * np.exp(LOCK))


def test_a_specimen_pulled_sideways_after_the_lock_is_held() -> None:
    """By a pressure of 0.2 MPa over kappa 1e3 and the smoothing of 1e-4; without it the ply goes on to widen."""
    assert 1.0 < widened(HELD) < 1.0 + 0.2 / 1e3 + 1.2e-4
    assert 1.0 < widened(CREEP) < 1.0 + 0.2 / 1e3 + 1.2e-4
    assert widened(FREE) > WIDEN


@pytest.mark.parametrize("other", [{"regimes": "squeeze"}, {"compaction": "smallest"}, {"after_lock": "stuck"}])
def test_what_does_not_go_with_it_is_refused_in_one_line(other: dict[str, str]) -> None:
    with pytest.raises(SceneError, match="after_lock"):
        Scene(**{"name": "held", "after_lock": "held", **other})
