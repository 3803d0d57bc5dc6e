"""The emitted source under gfortran and LLVM flang: both forms, every way of compiling it, the same numbers."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.diagnose.compilers import find_flang
from plyflow.hosts.abaqus.together import source_of_scenes
from plyflow.umat.compile import generate_cached, support_source
from plyflow.umat.library import CallResult, UmatLibrary
from umatgen.scene import SCENES, Scene

Array = NDArray[np.float64]
AGREE = 1e-13
# A penalty so low that it does not hide the rest of stress and tangent.
CONSTANTS = dict(SCENES["baked"].baked) | {"kappa": 1.0, "n1": 0.6, "n2": 0.0, "n3": -0.8}
STRICT = ("-ffree-form", "-std=f2018", "-Wall", "-Wextra", "-Werror")
STRICT_FIXED = ("-ffixed-form", "-std=f2018", "-Wall", "-Wextra", "-Werror")
LEGACY = ("-ffixed-form", "-std=legacy")
LEGACY_FREE = ("-ffree-form", "-std=legacy")
GFORTRAN = [
    (*form, *recursive)
    for form in (STRICT, STRICT_FIXED, LEGACY, LEGACY_FREE)
    for recursive in ((), ("-frecursive",))
]
# flang has no -frecursive: its locals are on the stack unless -fno-automatic says otherwise.
FLANG = [
    (*form, *automatic)
    for form in (("-ffree-form", "-std=f2018", "-pedantic", "-Werror"), ("-ffixed-form",))
    for automatic in ((), ("-fno-automatic",))
]
# What Abaqus ships is REAL*8, which the standard does not know; this is the same in its words.
STANDARD_ABA_PARAM = "      IMPLICIT DOUBLE PRECISION(A-H,O-Z)\n"


@dataclass(frozen=True)
class Made:
    """Source and manifest of a scene."""

    source: str
    manifest: dict[str, Any]


def generate(scene: Scene) -> Made:
    return Made(*generate_cached(scene)[:2])


def flang() -> str:
    found = find_flang()
    assert found is not None, "LLVM flang is not installed: apt-get install flang-19 ('./run test' does it)"
    return str(found)


def compiled(compiler: str, source: str, flags: Sequence[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Compile into folder/umat.o, the same text whatever the form."""
    (folder / "umat.for").write_text(source)
    command = [compiler, *flags, "-O2", "-fPIC", "-c", str(folder / "umat.for"), "-o", str(folder / "umat.o")]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def built(compiler: str, source: str, flags: Sequence[str], folder: Path) -> UmatLibrary:
    """Library of a source; what the compiler says, if only a warning, is an error."""
    folder.mkdir()
    answer = compiled(compiler, source, flags, folder)
    assert (answer.returncode, answer.stderr) == (0, ""), f"{compiler} {' '.join(flags)}: {answer.stderr[:2000]}"
    standins, library = folder / "standins.o", folder / "umat.so"
    made = ["-O2", "-fPIC", "-ffree-form", "-c", str(support_source()), "-o", str(standins)]
    subprocess.run([compiler, *made], cwd=folder, check=True, capture_output=True)
    objects = [str(folder / "umat.o"), str(standins)]
    subprocess.run([compiler, "-shared", *objects, "-o", str(library)], check=True, capture_output=True)
    return UmatLibrary(library)


def states(ntens: int, fibre: str, locked: bool) -> list[tuple[Array, Array]]:
    """Pairs F0, F1 in general position (for NTENS = 4 in the plane), squeezing or bleeding, the last at rest."""
    rng = np.random.default_rng(11)
    stretches = np.diag([1.001, 1.08, 0.90] if locked else [1.001, 1.02, 0.98])
    order = {"2": [2, 0, 1], "3": [1, 2, 0]}.get(fibre, [0, 1, 2])
    result = []
    for size in (2e-3, 2e-3, 2e-3, 1e-5, 0.0):
        start = (stretches + 3e-3 * rng.standard_normal((3, 3)))[np.ix_(order, order)]
        step = size * rng.standard_normal((3, 3))
        if ntens == 4:
            for matrix in (start, step):
                matrix[[0, 1, 2, 2], [2, 2, 0, 1]] = 0.0
        result.append((start, start + step))
    return result


def answers(library: UmatLibrary, manifest: dict[str, Any], material: str = "PLYFLOW") -> list[CallResult]:
    """All calls of a scene: both stages, five states each."""
    props = [CONSTANTS[row["name"]] for row in manifest["props"]]
    result = []
    for locked in (False, True):
        state = [1.0 if row["name"] == "locked" and locked else 0.0 for row in manifest["statev"]]
        for start, end in states(manifest["ntens"], manifest["scene"]["fibre"], locked):
            answer = library.call(
                start, end, 0.1, props, state, ntens=manifest["ntens"], material=material, temperature=72.5
            )
            result.append(answer)
    return result


def difference(first: Sequence[CallResult], second: Sequence[CallResult]) -> float:
    """Largest difference of stress, DDSDDE and state, relative to the largest entry of each; messages are the same."""
    worst = 0.0
    for one, other in zip(first, second, strict=True):
        assert (one.messages, one.stopped) == (other.messages, other.stopped)
        scale = {"stress": np.abs(other.stress).max(), "ddsdde": np.abs(other.ddsdde).max()}
        scale["statev"] = np.maximum(np.abs(other.statev), scale["stress"]) if other.statev.size else np.ones(0)
        for name, size in scale.items():
            gap = np.abs(getattr(one, name) - getattr(other, name))
            worst = max(worst, float(np.max(gap / np.where(size > 0, size, 1.0), initial=0.0)))
    return worst


@pytest.fixture(scope="module")
def wanted(tmp_path_factory: pytest.TempPathFactory) -> list[CallResult]:
    """The default scene by gfortran in the way Abaqus users compile."""
    made = generate(Scene())
    return answers(built("gfortran", made.source, LEGACY, tmp_path_factory.mktemp("wanted") / "b"), made.manifest)


def test_the_states_reach_both_stages(wanted: list[CallResult]) -> None:
    assert [result.messages for result in wanted] == [""] * 10
    assert {result.statev[4] for result in wanted} == {0.0, 1.0}


@pytest.mark.parametrize("flags", GFORTRAN, ids=" ".join)
def test_gfortran_takes_the_source_in_every_way_with_the_same_results(
    flags: tuple[str, ...], wanted: list[CallResult], tmp_path: Path
) -> None:
    made = generate(Scene())
    assert difference(answers(built("gfortran", made.source, flags, tmp_path / "b"), made.manifest), wanted) < AGREE


@pytest.mark.parametrize("flags", FLANG, ids=" ".join)
def test_flang_takes_the_source_in_both_forms_with_the_same_results(
    flags: tuple[str, ...], wanted: list[CallResult], tmp_path: Path
) -> None:
    made = generate(Scene())
    assert difference(answers(built(flang(), made.source, flags, tmp_path / "b"), made.manifest), wanted) < AGREE


@pytest.mark.parametrize("name", sorted(SCENES))
def test_every_scene_gives_the_same_numbers_by_both_compilers(name: str, tmp_path: Path) -> None:
    made = generate(SCENES[name])
    by = [
        answers(built(compiler, made.source, flags, tmp_path / str(number)), made.manifest)
        for number, (compiler, flags) in enumerate((("gfortran", STRICT), (flang(), FLANG[0])))
    ]
    assert any(np.abs(result.stress).max() > 0.0 for result in by[0])
    assert difference(*by) < AGREE


@pytest.mark.parametrize("layout", ["both", "fixed"])
def test_aba_param_inc_changes_nothing(layout: str, wanted: list[CallResult], tmp_path: Path) -> None:
    made = generate(Scene(include="aba_param", layout=layout))
    assert made.source.count("INCLUDE 'ABA_PARAM.INC'") == 1
    include = f"-I{support_source('ABA_PARAM.INC').parent}"
    ways = [("gfortran", (*LEGACY, include)), (flang(), ("-ffixed-form", include))]
    if layout == "both":
        ways += [("gfortran", (*LEGACY_FREE, include)), (flang(), ("-ffree-form", include))]
    for number, (compiler, flags) in enumerate(ways):
        library = built(compiler, made.source, flags, tmp_path / str(number))
        assert difference(answers(library, made.manifest), wanted) < AGREE


def test_the_include_is_clean_under_the_standard_where_its_file_is(wanted: list[CallResult], tmp_path: Path) -> None:
    (tmp_path / "ABA_PARAM.INC").write_text(STANDARD_ABA_PARAM)
    made = generate(Scene(include="aba_param"))
    library = built("gfortran", made.source, (*STRICT, f"-I{tmp_path}"), tmp_path / "b")
    assert difference(answers(library, made.manifest), wanted) < AGREE


def test_the_source_needs_no_other_file() -> None:
    for name, scene in SCENES.items():
        text = generate(scene).source.upper()
        assert not any(word in text for word in ("INCLUDE '", "\n      USE ", "\n        USE ", "MODULE ")), name


def build_together(compiler: str, flags: Sequence[str], folder: Path) -> UmatLibrary:
    return built(compiler, source_of_scenes([Scene(), SCENES["paper"], SCENES["plane"]]), flags, folder)


@pytest.mark.parametrize("way", ["gfortran both forms", "flang"])
def test_scenes_in_one_executable_are_each_what_they_are_alone(way: str, tmp_path: Path) -> None:
    compiler, flags = (flang(), FLANG[0]) if way == "flang" else ("gfortran", STRICT)
    together = build_together(compiler, flags, tmp_path / "together")
    for name in ("default", "paper", "plane"):
        made = generate(SCENES[name])
        alone = answers(built(compiler, made.source, flags, tmp_path / name), made.manifest)
        assert difference(answers(together, made.manifest, f"{name.upper()}-PLY 7"), alone) == 0.0
    assert not compiled("gfortran", source_of_scenes([Scene(), SCENES["paper"]]), LEGACY, tmp_path).returncode


def test_a_material_of_another_name_ends_the_analysis(tmp_path: Path) -> None:
    made = generate(Scene())
    for result in answers(build_together("gfortran", STRICT_FIXED, tmp_path / "b"), made.manifest, "DEFAULTS"):
        assert result.stopped
        assert "material DEFAULTS: this UMAT has no scene of that name" in result.messages


def test_the_scenes_in_one_executable_can_be_told_apart(tmp_path: Path) -> None:
    together, made = build_together("gfortran", STRICT, tmp_path / "b"), generate(Scene())
    assert difference(answers(together, made.manifest, "PAPER"), answers(together, made.manifest, "DEFAULT")) > 1e-6


PLANTED = {
    "an unused variable": ("LOGICAL :: locked", "LOGICAL :: locked, unused_one", "unused_one"),
    "an undeclared variable": ("ifault = 0\n", "ifault = 0\n      undeclared = 1\n", "undeclared"),
    "a missing continuation in column 73": ("STATEV, DDSDDE, SSE, SPD, SCD, RPL,       &", "STATEV, DDSDDE, SSE,", ""),
}


@pytest.mark.parametrize("what", PLANTED)
def test_a_planted_error_of_style_or_form_is_seen(what: str, tmp_path: Path) -> None:
    old, new, said = PLANTED[what]
    source = generate(Scene()).source
    assert old in source
    answer = compiled("gfortran", source.replace(old, new, 1), STRICT, tmp_path)
    assert answer.returncode != 0
    assert said in answer.stderr


def test_a_planted_rounding_is_seen_by_the_comparison(wanted: list[CallResult], tmp_path: Path) -> None:
    made = generate(Scene())
    assert made.source.count("power = g_visc*j2") == 1
    changed = made.source.replace("g_visc*j2\n", "g_visc*j2\n      g_visc = g_visc*1.000000000001d0\n", 1)
    library = built(flang(), changed, FLANG[0], tmp_path / "b")
    assert difference(answers(library, made.manifest), wanted) > AGREE
