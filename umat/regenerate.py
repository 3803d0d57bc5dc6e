"""Writes umat/generated anew: three shipped scenes to read, and the hash of every shipped scene's source."""

from __future__ import annotations

import hashlib
from pathlib import Path

from umatgen.pipeline import generate
from umatgen.scene import SCENES

FOLDER = Path(__file__).parent / "generated"
READ = ("default", "bdf1", "lean")

if __name__ == "__main__":
    lines = []
    for name, scene in SCENES.items():
        made = generate(scene)
        lines.append(f"{hashlib.sha256(made.source.encode()).hexdigest()}  {name}.for")
        if name in READ:
            (FOLDER / f"{name}.for").write_text(made.source)
            (FOLDER / f"{name}.json").write_text(made.manifest_text())
    (FOLDER / "sha256.txt").write_text("\n".join(lines) + "\n")
