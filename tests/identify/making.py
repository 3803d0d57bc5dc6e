"""Synthetic tests for the tests of `identify`, made by the law, written to a file and read back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from plyflow.case.case import Case
from plyflow.case.materials import find_material, known_materials
from plyflow.identify.model import NAMES
from plyflow.identify.refine import Fit, fit
from plyflow.identify.specimen import Specimen, read_specimen
from plyflow.run.synthetic import SyntheticTest, synthetic_test

Test = tuple[str, float, str]  # layup, width [mm], load
Noise = tuple[float, float]  # of thickness [mm] and force [N]
COLUMNS = [(name, t) for name, material in known_materials().items() for t in material.table.temperature]
RAMP_DWELL: list[Test] = [("CP", 15.0, "ramp-dwell"), ("BP", 15.0, "ramp-dwell")]
BOTH_LOADS: list[Test] = [("CP", 15.0, "ramp-dwell"), ("CP", 15.0, "monotonic")]


def truth(material: str, temperature: float) -> dict[str, float]:
    """Table column of a material."""
    return dict(vars(find_material(material).at(temperature)))


def synthetic(material: str, temperature: float, test: Test) -> SyntheticTest:
    """A test without noise."""
    layup, width, load = test
    return synthetic_test(Case(material, temperature, layup, width, load))


def read_back(tests: Sequence[SyntheticTest], folder: Path) -> list[Specimen]:
    """Tests through files."""
    specimens = []
    for place, test in enumerate(tests):
        path = folder / f"test{place}.csv"
        path.write_text(test.text())
        specimens.append(read_specimen(path, {}, {}))
    return specimens


def repeated(tests: Sequence[Test], noise: Noise, repeats: int, folder: Path) -> list[tuple[Fit, dict[str, float]]]:
    """Fits of noisy tests, the columns of both tables in turn, each with its truth."""
    pure = {column: [synthetic(*column, test) for test in tests] for column in COLUMNS}
    done = []
    for repeat in range(repeats):
        column = COLUMNS[repeat % len(COLUMNS)]
        seeds = np.random.SeedSequence([7, repeat]).generate_state(len(tests))
        noisy = [test.with_noise(*noise, int(seed)) for test, seed in zip(pure[column], seeds, strict=True)]
        done.append((fit(read_back(noisy, folder)), truth(*column)))
    return done


def narrowed(one: Fit, factor: float) -> Fit:
    """A fit with its intervals narrower by a factor."""
    estimates = {}
    for name in NAMES:
        old = one.estimates[name]
        low, high = (old.value + factor * (end - old.value) for end in (old.low, old.high))
        estimates[name] = replace(old, low=low, high=high)
    return replace(one, estimates=estimates)
