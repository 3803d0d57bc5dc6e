"""The emitted source under gfortran and LLVM flang: both forms, every way of compiling it, the same numbers."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

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
CONSTANTS = dict(SCENES["baked"].baked) | {"kappa": 1.0, "n1": 0.6, "n2": 0.0, "n3": -0.8, "m1": 0.8, "m2": 0.0, "m3": 0.6}
STRICT = ("-ffixed-form", "-std=f2018", "-Wall", "-Wextra", "-Werror")
FREE = ("-ffree-form", *STRICT[1:])
LEGACY = ("-ffixed-form", "-std=legacy")
WIDE = (*LEGACY, "-ffixed-line-length-132")  # as Abaqus compiles by default
FLANG, FLANG_FREE = (("-std=f2018", "-pedantic", "-Werror", form) for form in ("-ffixed-form", "-ffree-form"))
# flang has no -frecursive: its locals are on the stack unless -fno-automatic says otherwise.
WAYS = [
    *(("gfortran", (*form, *recursive)) for form in (STRICT, LEGACY, WIDE, FREE) for recursive in ((), ("-frecursive",))),
    *(("flang", (*form, *automatic)) for form in (FLANG, FLANG_FREE) for automatic in ((), ("-fno-automatic",))),
    ("flang", (*FLANG, "-ffixed-line-length=132")),
]
# What Abaqus ships is REAL*8, which the standard does not know; this is the same in its words.
STANDARD_ABA_PARAM = "      IMPLICIT DOUBLE PRECISION(A-H,O-Z)\n"


class Made(NamedTuple):
    """Source and manifest of a scene."""

    source: str
    manifest: dict[str, Any]


def generate(scene: Scene) -> Made:
    return Made(*generate_cached(scene)[:2])


def path_of(compiler: str) -> str:
    if compiler != "flang":
        return compiler
    found = find_flang()
    assert found is not None, "LLVM flang is not installed: apt-get install flang-19 ('./run test' does it)"
    return str(found)


def compiled(compiler: str, source: str, flags: Sequence[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Compile into folder/umat.o, the same text whatever the form."""
    (folder / "umat.for").write_text(source)
    command = [path_of(compiler), *flags, "-O2", "-fPIC", "-c", str(folder / "umat.for"), "-o", str(folder / "umat.o")]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def built(compiler: str, source: str, flags: Sequence[str], folder: Path) -> UmatLibrary:
    """Library of a source; what the compiler says, if only a warning, is an error."""
    folder.mkdir()
    answer = compiled(compiler, source, flags, folder)
    assert (answer.returncode, answer.stderr) == (0, ""), f"{compiler} {' '.join(flags)}: {answer.stderr[:2000]}"
    made = [path_of(compiler), "-O2", "-fPIC", "-ffree-form", "-c", str(support_source()), "-o", "standins.o"]
    linked = [path_of(compiler), "-shared", "umat.o", "standins.o", "-o", "umat.so"]
    for command in (made, linked):
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return UmatLibrary(folder / "umat.so")


def states(ntens: int, fibre: str, locked: bool) -> list[tuple[Array, Array]]:
    """Pairs F0, F1 in general position (for NTENS = 4 in the plane), squeezing or bleeding, the last at rest."""
    rng = np.random.default_rng(11)
    stretches = np.diag([1.001, 1.16, 0.84] if locked else [1.001, 1.02, 0.98])
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
    props, ntens = [CONSTANTS[row["name"]] for row in manifest["props"]], manifest["ntens"]
    result = []
    for locked in (False, True):
        state = [1.0 if row["name"] == "locked" and locked else 0.0 for row in manifest["statev"]]
        for start, end in states(ntens, manifest["scene"]["fibre"], locked):
            result.append(library.call(start, end, 0.1, props, state, ntens=ntens, material=material, temperature=72.5))
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
    """The default scene by gfortran in the way Abaqus users compile; it reaches both stages without a message."""
    made = generate(Scene())
    found = answers(built("gfortran", made.source, LEGACY, tmp_path_factory.mktemp("wanted") / "b"), made.manifest)
    assert [result.messages for result in found] == [""] * 10
    assert {result.statev[4] for result in found} == {0.0, 1.0}
    return found


@pytest.mark.parametrize(("compiler", "flags"), WAYS, ids=str)
def test_both_compilers_take_the_source_in_every_way_with_the_same_results(
    compiler: str, flags: tuple[str, ...], wanted: list[CallResult], tmp_path: Path
) -> None:
    made = generate(Scene(form="free" if "-ffree-form" in flags else "fixed"))
    assert difference(answers(built(compiler, made.source, flags, tmp_path / "b"), made.manifest), wanted) < AGREE


@pytest.mark.parametrize("name", sorted(SCENES))
def test_every_scene_gives_the_same_numbers_by_both_compilers_and_needs_no_other_file(name: str, tmp_path: Path) -> None:
    made = generate(SCENES[name])
    by = [
        answers(built(compiler, made.source, flags, tmp_path / compiler), made.manifest)
        for compiler, flags in (("gfortran", STRICT), ("flang", FLANG))
    ]
    assert any(np.abs(result.stress).max() > 0.0 for result in by[0])
    assert difference(*by) < AGREE
    assert not any(word in made.source.upper() for word in ("INCLUDE '", "\n      USE ", "\n        USE ", "MODULE "))


@pytest.mark.parametrize("form", ["fixed", "free"])
def test_aba_param_inc_changes_nothing(form: str, wanted: list[CallResult], tmp_path: Path) -> None:
    made = generate(Scene(include="aba_param", form=form))
    assert made.source.count("INCLUDE 'ABA_PARAM.INC'") == 1
    shipped, own = f"-I{support_source('ABA_PARAM.INC').parent}", f"-I{tmp_path}"
    (tmp_path / "ABA_PARAM.INC").write_text(STANDARD_ABA_PARAM)
    strict = STRICT if form == "fixed" else FREE
    ways = (("gfortran", (f"-f{form}-form", "-std=legacy", shipped)), ("flang", (f"-f{form}-form", shipped)))
    for number, (compiler, flags) in enumerate((*ways, ("gfortran", (*strict, own)))):
        library = built(compiler, made.source, flags, tmp_path / str(number))
        assert difference(answers(library, made.manifest), wanted) < AGREE


def build_together(compiler: str, flags: Sequence[str], folder: Path) -> UmatLibrary:
    return built(compiler, source_of_scenes([Scene(), SCENES["paper"], SCENES["plane"]]), flags, folder)


@pytest.mark.parametrize(("compiler", "flags"), [("gfortran", STRICT), ("gfortran", WIDE), ("flang", FLANG)])
def test_scenes_in_one_executable_are_each_what_they_are_alone(
    compiler: str, flags: tuple[str, ...], tmp_path: Path
) -> None:
    together = build_together(compiler, flags, tmp_path / "together")
    for name in ("default", "paper", "plane"):
        made = generate(SCENES[name])
        alone = answers(built(compiler, made.source, flags, tmp_path / name), made.manifest)
        assert difference(answers(together, made.manifest, f"{name.upper()}-PLY 7"), alone) == 0.0


def test_the_scenes_in_one_executable_can_be_told_apart_and_another_name_ends_the_analysis(tmp_path: Path) -> None:
    together, made = build_together("gfortran", STRICT, tmp_path / "b"), generate(Scene())
    assert difference(answers(together, made.manifest, "PAPER"), answers(together, made.manifest, "DEFAULT")) > 1e-6
    for result in answers(together, made.manifest, "DEFAULTS"):
        assert result.stopped
        assert "material DEFAULTS: this UMAT has no scene of that name" in result.messages


PLANTED = {
    "an unused variable": ("LOGICAL :: locked", "LOGICAL :: locked, unused_one", "unused_one"),
    "an undeclared variable": ("ifault = 0\n", "ifault = 0\n        undeclared = 1\n", "undeclared"),
    "a missing continuation in column 6": ("     &", "      ", ""),
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
    both_stages = "g_visc = det_f*micro*ply*rate/j2_unit\n"
    assert made.source.count(both_stages) == 2
    changed = made.source.replace(both_stages, f"{both_stages}          g_visc = g_visc*1.000000000001d0\n")
    library = built("flang", changed, FLANG, tmp_path / "b")
    assert difference(answers(library, made.manifest), wanted) > AGREE
