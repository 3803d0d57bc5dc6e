"""Compiled blocks return their registered equations; one altered coefficient in any block is noticed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from planting import replace as replace_text
from plyflow.audit.machine import (
    TOLERANCE,
    compare_blocks,
    compare_whole,
    registered_calls,
    relative_difference,
)
from plyflow.audit.report import Audit
from plyflow.umat.compile import generate_cached
from umataudit import BlockCall, UnknownBlockError, block_calls, random_states
from umataudit.creep_blocks import integral, mean
from umatgen.pipeline import Generated, generate
from umatgen.scene import SCENES, Scene

_NUMBER = re.compile(r"(?<![\w.])(\d+\.\d+d\d+)")

KNOWN = {**SCENES, "smallest": Scene(name="smallest", compaction="smallest")}
ALSO = {
    "held": Scene(name="held", after_lock="held", integrator="bdf1"),
    "heldstress": Scene(name="heldstress", after_lock="held", tangent="none", integrator="bdf1", incompressibility="none"),
    "papercreep": Scene(name="papercreep", tangent="paper"),
    "across": Scene(name="across", fibre="2", normal="free"),
    "turned": Scene(name="turned", fibre="3", normal="1", tangent="none"),
    "turnedsmall": Scene(name="turnedsmall", fibre="3", normal="1", compaction="smallest", integrator="bdf1"),
}
_OF_BOTH = ("moduli", "start", "compaction", "kinematics", "squeeze", "bleed", "elastic", "stress", "counted", "gradient", "tangent")
_OF_CREEP = ("path", "join", "creep", "load")
BLOCKS = dict.fromkeys(KNOWN, _OF_BOTH)
BLOCKS |= {name: (*_OF_BOTH, *_OF_CREEP) for name, scene in KNOWN.items() if scene.creep}
_OF_CROSSING = {"bleed", "squeeze", "join", "counted"}
BLOCKS |= {name: tuple(b for b in BLOCKS[name] if b not in _OF_CROSSING - {name}) for name in ("squeeze", "bleed")}
BLOCKS["viscous"] = tuple(b for b in BLOCKS["viscous"] if b != "moduli")
BLOCKS["stressonly"] = tuple(b for b in BLOCKS["stressonly"] if b not in {"counted", "gradient", "tangent"})
BLOCKS["printed"] = (*_OF_BOTH, "printed_squeeze", "printed_bleed")
BLOCKS["free"] = (*BLOCKS["free"], "frame")
"""Every block of every shipped scene, and of the one with the smallest transverse stretch."""


@cache
def callable_blocks(scene: str = "default") -> Generated:
    """A scene with a symbol for each block."""
    source, manifest, _ = generate_cached(replace((KNOWN | ALSO)[scene], procedures="external"))
    return Generated(source, manifest)


@cache
def calls(scene: str) -> list[BlockCall]:
    """What its blocks must return."""
    return registered_calls(callable_blocks(scene).manifest)


def altered(source: str, name: str, change: Callable[[str], str], scene: str = "default") -> str:
    """The source with one procedure changed."""
    pattern = re.compile(rf"( *SUBROUTINE pf_{scene}_{name}\(.*?END SUBROUTINE pf_{scene}_{name}\n)", re.DOTALL)
    found = pattern.search(source)
    assert found is not None, name
    changed = change(found.group(1))
    assert changed != found.group(1), name
    return source.replace(found.group(1), changed)


def larger_coefficient(procedure: str) -> str:
    """The last number of a procedure with its last digit changed, else the last plus a minus; the line keeps its length."""
    where = ([None, *(found for found in _NUMBER.finditer(procedure) if len(found.group()) < 12)])[-1]
    if where is None:
        return " - ".join(procedure.rsplit(" + ", 1))
    mantissa, exponent = where.group(1).split("d")
    text = f"{mantissa[:-1]}{(int(mantissa[-1]) + 1) % 10}d{exponent}"
    return procedure[: where.start()] + text + procedure[where.end() :]


def test_all_blocks_and_the_whole_umat_agree(audited: Audit) -> None:
    assert audited.agrees
    assert max(block.difference for block in audited.blocks) <= TOLERANCE
    assert {"umat", "squeeze", "bleed", "stress", "tangent", "kinematics"} <= {block.name for block in audited.blocks}


@pytest.mark.parametrize("scene", BLOCKS)
def test_one_altered_coefficient_in_every_block_is_noticed(scene: str) -> None:
    """All blocks of a scene are altered at once, and each is called by itself: none may agree."""
    blocks = callable_blocks(scene)
    source = blocks.source
    for name in BLOCKS[scene]:
        source = altered(source, name, larger_coefficient, scene)
    results = compare_blocks(source, blocks.manifest, calls(scene))
    assert [result.name for result in results if result.agrees] == []
    assert {result.name for result in results} == set(BLOCKS[scene])


@pytest.mark.parametrize("scene", BLOCKS)
def test_every_emitted_block_is_altered_by_a_test(scene: str) -> None:
    emitted = {block["name"] for block in callable_blocks(scene).manifest["blocks"]}
    assert emitted == set(BLOCKS[scene]) - {"path"}


def test_every_emitted_block_is_in_the_chain_of_a_relation(audited: Audit) -> None:
    said = " ".join(line.said for row in audited.rows for line in row.chain if line.said.startswith("emitted"))
    assert {name for name in _OF_BOTH if f"block {name};" not in said} == set()


def larger_stress(source: str) -> str:
    """The stress a part in a million larger."""
    return altered(source, "stress", lambda p: p.replace("per_volume = 1.0d0/", "per_volume = 1.000001d0/"))


def test_an_altered_stress_is_noticed_in_the_whole_umat() -> None:
    shipped = generate(Scene())
    assert compare_whole(shipped.source, shipped.manifest).agrees
    assert not compare_whole(larger_stress(shipped.source), shipped.manifest).agrees


def test_a_tangent_with_all_rates_where_the_lock_is_passed_is_noticed() -> None:
    """J2 counts those through the thickness there, and so does the right factor of the viscous dyad."""
    shipped = generate(Scene())
    all_rates = replace_text("normal, y_counted, r_visc", "normal, y_rate, r_visc", once=True)
    wrong = compare_whole(all_rates(shipped.source), shipped.manifest)
    assert (wrong.agrees, wrong.output) == (False, "ddsdde")


@pytest.mark.parametrize("name", [*(name for name in KNOWN if name != "default"), *ALSO])
def test_other_scenes_agree_too(name: str) -> None:
    blocks = callable_blocks(name)
    results = [*compare_blocks(blocks.source, blocks.manifest, calls(name)), compare_whole(blocks.source, blocks.manifest)]
    assert [result for result in results if not result.agrees] == []


@pytest.mark.parametrize("flow", ["squeeze", "bleed", "cross"])
def test_the_panels_of_the_path_stand_for_the_integral(flow: str) -> None:
    """The mean of the viscosity over the path, eight panels against quadrature, in the states of the comparison."""
    found = [call.inputs for call in calls("default") if call.name == "path"]
    worst = max(abs(mean(*given.values()) / integral(*given.values()) - 1) for given in found)
    assert 1e-9 < worst < 2e-2
    assert flow in {state.flow for state in random_states(callable_blocks().manifest, 3)}


def test_a_block_without_registered_equations_is_refused() -> None:
    manifest: dict[str, Any] = dict(callable_blocks().manifest)
    manifest["blocks"] = [{"name": "unheard_of", "equation": "0", "inputs": [], "outputs": []}]
    with pytest.raises(UnknownBlockError, match="unheard_of"):
        list(block_calls(manifest, random_states(manifest, 1)))


def test_what_is_not_a_number_differs_infinitely() -> None:
    assert relative_difference(np.array([1.0, np.nan]), [1.0, 2.0]) == float("inf")
    assert relative_difference(np.array([1.0, 2.0]), [1.0, 2.5]) == pytest.approx(0.2)


def test_states_are_the_same_on_every_run() -> None:
    first, second = (random_states(callable_blocks().manifest, 4) for _ in range(2))
    assert first == second
    assert {state.flow for state in first} == {"squeeze", "bleed", "cross"}
    assert {state.past is None for state in first} == {True, False}
    assert replace(first[0], flow="bleed") != first[0]
