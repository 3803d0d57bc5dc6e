"""Compiled blocks return their registered equations; one altered coefficient in any block is noticed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from plyflow.audit.machine import TOLERANCE, compare_blocks, compare_scene, compare_whole, relative_difference
from plyflow.audit.report import Audit
from plyflow.errors import InputError
from umatgen.audit import UnknownBlockError, block_calls, not_comparable, random_states
from umatgen.pipeline import Generated, generate
from umatgen.scene import SCENES, Scene

_NUMBER = re.compile(r"(?<![\w.])(\d+\.\d+d-?\d+)")


@pytest.fixture(scope="module")
def callable_blocks() -> Generated:
    """The default scene with a symbol for each block."""
    return generate(Scene(procedures="external"))


def altered(source: str, name: str, change: Callable[[str], str]) -> str:
    """The source with one procedure changed."""
    pattern = re.compile(rf"( *SUBROUTINE pf_default_{name}\(.*?END SUBROUTINE pf_default_{name}\n)", re.DOTALL)
    found = pattern.search(source)
    assert found is not None, name
    changed = change(found.group(1))
    assert changed != found.group(1), name
    return source.replace(found.group(1), changed)


def larger_coefficient(procedure: str) -> str:
    """The last number of a procedure with its last digit changed; the line keeps its length."""
    where = list(_NUMBER.finditer(procedure))[-1]
    mantissa, exponent = where.group(1).split("d")
    text = f"{mantissa[:-1]}{(int(mantissa[-1]) + 1) % 10}d{exponent}"
    return procedure[: where.start()] + text + procedure[where.end() :]


def test_all_blocks_and_the_whole_umat_agree(audited: Audit) -> None:
    assert audited.agrees
    assert max(block.difference for block in audited.blocks) <= TOLERANCE
    assert {"umat", "squeeze", "bleed", "stress", "tangent", "kinematics"} <= {block.name for block in audited.blocks}


@pytest.mark.parametrize(
    "name", ["moduli", "start", "kinematics", "transverse", "squeeze", "bleed", "elastic", "gradient", "tangent"]
)
def test_one_altered_coefficient_in_a_block_is_noticed(name: str, callable_blocks: Generated) -> None:
    source = altered(callable_blocks.source, name, larger_coefficient)
    results = compare_blocks(source, callable_blocks.manifest)
    assert [result.name for result in results if not result.agrees] == [name]


def larger_stress(source: str) -> str:
    """The stress a part in a million larger."""
    return altered(source, "stress", lambda p: p.replace("per_volume = 1.0d0/", "per_volume = 1.000001d0/"))


def test_an_altered_stress_is_noticed_in_the_block_and_in_the_whole_umat(callable_blocks: Generated) -> None:
    results = compare_blocks(larger_stress(callable_blocks.source), callable_blocks.manifest)
    assert [result.name for result in results if not result.agrees] == ["stress"]
    shipped = generate(Scene())
    assert compare_whole(shipped.source, shipped.manifest).agrees
    assert not compare_whole(larger_stress(shipped.source), shipped.manifest).agrees


COMPARABLE = [name for name, scene in SCENES.items() if name != "default" and not not_comparable(scene.as_dict())]


@pytest.mark.parametrize("name", COMPARABLE)
def test_other_scenes_agree_too(name: str) -> None:
    differing = [result for result in compare_scene(SCENES[name]) if not result.agrees]
    assert differing == []


def test_a_scene_without_registered_equations_is_refused() -> None:
    with pytest.raises(InputError, match="audit scene 'default'"):
        compare_scene(Scene(name="turned", fibre="3"))


def test_a_block_without_registered_equations_is_refused(callable_blocks: Generated) -> None:
    manifest: dict[str, Any] = dict(callable_blocks.manifest)
    manifest["blocks"] = [{"name": "unheard_of", "equation": "0", "inputs": [], "outputs": []}]
    with pytest.raises(UnknownBlockError, match="unheard_of"):
        list(block_calls(manifest, random_states(manifest, 1)))


def test_what_is_not_a_number_differs_infinitely() -> None:
    assert relative_difference(np.array([1.0, np.nan]), [1.0, 2.0]) == float("inf")
    assert relative_difference(np.array([1.0, 2.0]), [1.0, 2.5]) == pytest.approx(0.2)


def test_states_are_the_same_on_every_run(callable_blocks: Generated) -> None:
    first, second = (random_states(callable_blocks.manifest, 4) for _ in range(2))
    assert first == second
    assert {state.flow for state in first} == {"squeeze", "bleed"}
    assert replace(first[0], flow="bleed") != first[0]
