"""Write the shipped scenes into umat/generated: run after a change of the generator."""

from __future__ import annotations

from pathlib import Path

from umatgen.pipeline import generate
from umatgen.scene import SCENES

FOLDER = Path(__file__).parent / "generated"

for name, scene in SCENES.items():
    made = generate(scene)
    (FOLDER / f"{name}.for").write_text(made.source)
    (FOLDER / f"{name}.json").write_text(made.manifest_text())
