"""Emission: the same bytes everywhere, the committed sources up to date, readable and free of shared state."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from emitted import generate
from umatgen.scene import SCENES, Scene, SceneError, scene_by_name

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "umat" / "generated"
ARGUMENTS = (  # Abaqus User Subroutines Reference Guide, UMAT
    "STRESS STATEV DDSDDE SSE SPD SCD RPL DDSDDT DRPLDE DRPLDT STRAN DSTRAN TIME DTIME TEMP DTEMP PREDEF DPRED CMNAME NDI NSHR "
    "NTENS NSTATV PROPS NPROPS COORDS DROT PNEWDT CELENT DFGRD0 DFGRD1 NOEL NPT LAYER KSPT KSTEP KINC"
)


def unbroken(source: str) -> str:
    """The source with continued lines joined and comments gone."""
    code = "\n".join(line for line in source.splitlines() if not line.startswith("!"))
    return re.sub(r"\n     &\s*", " ", code)


def test_the_interface_has_the_37_arguments_of_abaqus_in_order() -> None:
    head = re.search(r"SUBROUTINE UMAT\((.*?)\)\n", unbroken(generate(Scene()).source), re.S)
    assert head is not None
    assert [name.strip() for name in head.group(1).split(",")] == ARGUMENTS.split()
    assert len(ARGUMENTS.split()) == 37


@pytest.mark.parametrize("seed", ["0", "4711"])
def test_the_bytes_do_not_depend_on_the_process(seed: str) -> None:
    program = (
        "from umatgen.pipeline import generate; from umatgen.scene import Scene; g = generate(Scene());"
        "print(g.source + g.manifest_text(), end='')"
    )
    answer = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONHASHSEED": seed},
    )
    here = generate(Scene())
    assert answer.stdout == here.source + here.manifest_text()


def committed_hashes() -> dict[str, str]:
    """Hash of the source of each shipped scene, by name."""
    rows = (line.split() for line in (FOLDER / "sha256.txt").read_text().splitlines())
    return {file.removesuffix(".for"): value for value, file in rows}


@pytest.mark.parametrize("name", sorted(SCENES))
def test_the_committed_hash_is_that_of_what_the_generator_makes(name: str) -> None:
    assert committed_hashes()[name] == hashlib.sha256(generate(SCENES[name]).source.encode()).hexdigest()


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.for")), ids=lambda p: p.stem)
def test_the_committed_source_is_what_the_generator_makes(path: Path) -> None:
    made = generate(SCENES[path.stem])
    assert path.read_text() == made.source
    assert json.loads(path.with_suffix(".json").read_text()) == made.manifest


def forbidden(source: str) -> list[str]:
    """Statements that would make the source unsafe for threads, or write in the hot path."""
    pattern = r"^\s*(COMMON|SAVE|WRITE|PRINT|OPEN|DATA)\b|,\s*SAVE\b"
    return [line for line in unbroken(source).splitlines() if re.search(pattern, line, re.I)]


@pytest.mark.parametrize("name", sorted(SCENES))
def test_the_source_has_no_shared_state_and_no_output(name: str) -> None:
    source = generate(SCENES[name]).source
    assert forbidden(source) == []
    assert forbidden(source + "      SAVE\n") == ["      SAVE"]


def test_every_procedure_is_headed_by_its_equation_inputs_and_outputs() -> None:
    generated = generate(Scene())
    for block in generated.manifest["blocks"]:  # type: ignore[attr-defined]
        head = generated.source.split(f"SUBROUTINE pf_default_{block['name']}(")[0].rsplit("!-----", 1)[1]
        assert f"! Equation: {block['equation']}" in head
        assert all(re.search(rf"^!   {n}\b", head, re.M) for n in (*block["inputs"], *block["outputs"]))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "Bad Name"}, "scene name 'Bad Name'"),
        ({"tangent": "numeric"}, "tangent 'numeric' is not known; choose one of consistent"),
        ({"fibre_fraction": 1.5}, r"fibre_fraction = 1.5 must lie in \(0, 1\)"),
        ({"fibre": "3"}, "normal '3' is the fibre's axis"),
        ({"stress_state": "plane", "fibre": "free"}, "a fibre and a normal along axes"),
    ],
)
def test_a_bad_scene_is_refused_with_value_bound_and_remedy(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Scene(**arguments)  # type: ignore[arg-type]


def test_an_unknown_scene_lists_the_known_ones() -> None:
    with pytest.raises(SceneError, match="default"):
        scene_by_name("nope")
