"""The parts of the decks that CalculiX shares run there: geometry, loads, steps, controls, laminate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from plyflow.case.case import Case, law_parameters, property_values, props_vector
from plyflow.case.programme import load_programme
from plyflow.hosts.abaqus.jobs import element_deck
from plyflow.hosts.calculix.build import ensure_ccx
from plyflow.hosts.calculix.faces import Face, native_face
from plyflow.hosts.calculix.job import JobResult, run_job
from plyflow.law import LawHistory, integrate
from plyflow.umat.compile import generate_cached
from umatgen.scene import SCENES

ORIENTATION = "SYSTEM=RECTANGULAR\n0.0, 0.0, 1.0, 1.0, 0.0, 0.0\n"


@pytest.fixture(scope="module")
def face() -> Face:
    ensure_ccx()
    return native_face(SCENES["bdf1"])


def run(
    element: str, load: str, layup: str, face: Face, folder: Path, turned: str = ORIENTATION, **changes: float
) -> tuple[JobResult, LawHistory, np.ndarray, np.ndarray]:
    """The job of an element and a load in CalculiX, the one-dimensional law at the same times, thickness and width ratios."""
    manifest, programme = generate_cached(SCENES["bdf1"])[1], load_programme(load, 15.0)
    values = property_values(Case("IM7-8552", 70.0, layup, 15.0, load), manifest)
    constants = props_vector(values | changes, manifest)
    deck = element_deck(element, (15.0, values["h0"]), programme, constants, manifest, "calculix", face.material)
    text = deck.replace(ORIENTATION, turned)
    result = run_job(f"{element}_{load}_{layup}", text, [face], folder, must_finish=turned == ORIENTATION)
    moved, times = result.tables["U", "PLATEHIGH"].values, result.tables["U", "PLATEHIGH"].time
    edge, plate = (1, 2) if element.startswith("C3D8") else (0, 1)
    law = integrate(law_parameters(values), programme, np.minimum(times, programme.end))
    return result, law, 1.0 + moved[:, :, plate].mean(axis=1) / values["h0"], 1.0 + moved[:, :, edge].max(axis=1) / 15.0


@pytest.mark.parametrize(
    ("element", "load", "layup"),
    [
        ("C3D8", "ramp-dwell", "BP"),
        ("C3D8", "monotonic", "CP"),
        ("C3D8R", "monotonic", "BP"),
        ("CPE4", "ramp-dwell", "BP"),
        ("CAX4", "monotonic", "BP"),
    ],
)
def test_the_paper_s_programme_under_load_control_gives_the_one_dimensional_law(
    element: str, load: str, layup: str, face: Face, tmp_path: Path
) -> None:
    result, law, height, width = run(element, load, layup, face, tmp_path)
    # Backward differences with increments up to 20 s: an error in the quick first seconds that the creep forgets.
    late = result.tables["U", "PLATEHIGH"].time > 600.0
    assert np.abs(height - law.thickness_ratio)[late].max() < 1e-3
    assert abs(height[-1] - law.thickness_ratio[-1]) < 6e-4
    # The increment that passes the lock is not cut to it. The widening stretches the ring's fibre by 6e-4
    # (displacement over radius), and the fibre pulls the edge back.
    assert abs(width[-1] - law.width_ratio[-1]) < (2e-3 if element == "CAX4" else 2e-4)
    locked = result.tables["SDV", "PLY1"].of(1, 1)[:, 4]
    assert (locked[0], locked[-1]) == (0.0, 1.0)


def test_another_material_would_be_seen(face: Face, tmp_path: Path) -> None:
    _, law, height, _ = run("C3D8", "monotonic", "CP", face, tmp_path, b_bleed=-31.5, b_squeeze=-14.8)
    assert abs(height[-1] - law.thickness_ratio[-1]) > 6e-4


def test_another_fibre_direction_would_be_seen(face: Face, tmp_path: Path) -> None:
    """The fibre in the plane of a CPE4 holds its width."""
    along_edge = ORIENTATION.replace("0.0, 0.0, 1.0, 1.0, 0.0, 0.0", "1.0, 0.0, 0.0, 0.0, 1.0, 0.0")
    _, law, _, width = run("CPE4", "monotonic", "BP", face, tmp_path, along_edge, kappa=100.0)
    assert abs(width[-1] - law.width_ratio[-1]) > 1e-2
