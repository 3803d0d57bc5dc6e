"""Compiled blocks return their registered equations; one altered coefficient in any block is noticed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from plyflow.audit.machine import (
    TOLERANCE,
    compare_blocks,
    compare_scene,
    compare_whole,
    registered_calls,
    relative_difference,
)
from plyflow.audit.report import Audit
from plyflow.errors import InputError
from plyflow.umat.compile import generate_cached
from umataudit import BlockCall, UnknownBlockError, block_calls, not_comparable, random_states
from umataudit.whole import supported
from umatgen.pipeline import Generated, generate
from umatgen.scene import SCENES, Scene

_NUMBER = re.compile(r"(?<![\w.])(\d+\.\d+d-?\d+)")


COMPARABLE = [name for name, scene in SCENES.items() if not not_comparable(scene.as_dict())]
BLOCKS = {
    "default": (
        "moduli", "start", "compaction", "kinematics", "squeeze", "bleed", "elastic", "stress", "gradient", "tangent",
    ),
    "printed": ("printed_squeeze", "printed_bleed", "gradient"),
}  # fmt: skip
"""Every block that a comparable scene emits, by the scene in which it is altered."""


@cache
def callable_blocks(scene: str = "default") -> Generated:
    """A scene with a symbol for each block."""
    source, manifest, _ = generate_cached(replace(SCENES[scene], procedures="external"))
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
    where = ([None, *_NUMBER.finditer(procedure)])[-1]
    if where is None:
        return " - ".join(procedure.rsplit(" + ", 1))
    mantissa, exponent = where.group(1).split("d")
    text = f"{mantissa[:-1]}{(int(mantissa[-1]) + 1) % 10}d{exponent}"
    return procedure[: where.start()] + text + procedure[where.end() :]


def test_all_blocks_and_the_whole_umat_agree(audited: Audit) -> None:
    assert audited.agrees
    assert max(block.difference for block in audited.blocks) <= TOLERANCE
    assert {"umat", "squeeze", "bleed", "stress", "tangent", "kinematics"} <= {block.name for block in audited.blocks}


@pytest.mark.parametrize(("scene", "name"), [(scene, name) for scene, names in BLOCKS.items() for name in names])
def test_one_altered_coefficient_in_a_block_is_noticed(scene: str, name: str) -> None:
    blocks = callable_blocks(scene)
    source = altered(blocks.source, name, larger_coefficient, scene)
    results = compare_blocks(source, blocks.manifest, calls(scene))
    assert [result.name for result in results if not result.agrees] == [name]


def test_every_emitted_block_is_altered_by_a_test() -> None:
    def blocks(scene: str) -> dict[tuple[str, str], str]:
        return {(block["name"], block["equation"]): scene for block in callable_blocks(scene).manifest["blocks"]}

    emitted = {key for scene in COMPARABLE for key in blocks(scene)}
    altered_here = {key for scene, names in BLOCKS.items() for key in blocks(scene) if key[0] in names}
    assert emitted == altered_here


def test_every_emitted_block_is_in_the_chain_of_a_relation(audited: Audit) -> None:
    said = " ".join(line.said for row in audited.rows for line in row.chain if line.said.startswith("emitted"))
    assert {name for name in BLOCKS["default"] if f"block {name};" not in said} == set()


def larger_stress(source: str) -> str:
    """The stress a part in a million larger."""
    return altered(source, "stress", lambda p: p.replace("per_volume = 1.0d0/", "per_volume = 1.000001d0/"))


def test_an_altered_stress_is_noticed_in_the_whole_umat() -> None:
    shipped = generate(Scene())
    assert compare_whole(shipped.source, shipped.manifest).agrees
    assert not compare_whole(larger_stress(shipped.source), shipped.manifest).agrees


@pytest.mark.parametrize("name", [name for name in COMPARABLE if name != "default"])
def test_other_scenes_agree_too(name: str) -> None:
    made = callable_blocks(name)
    results = compare_blocks(made.source, made.manifest, calls(name))
    if supported(made.manifest["scene"]):
        results.append(compare_whole(made.source, made.manifest))
    assert [result for result in results if not result.agrees] == []


def test_a_scene_without_registered_equations_is_refused() -> None:
    with pytest.raises(InputError, match="audit scene 'default'"):
        compare_scene(Scene(name="turned", fibre="3", normal="1"))
    assert "rests on the last increment" in not_comparable({"name": "two", "integrator": "bdf2"})


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
    assert {state.flow for state in first} == {"squeeze", "bleed"}
    assert replace(first[0], flow="bleed") != first[0]
