"""Many points with scattered constants, pressed as one: plane-strain meshes under a rigid plate, and points in series.

The rules are one set for every UMAT, mesh and seed (docs/many-points.md): `many_points.Rules` as it stands, which leaves
Abaqus's test of the displacement correction out; `corrected` takes it in, and every result says which it was. IM7-8552 at
70 degC, BP, 15 mm, ramp-dwell; k and h0 of every point are drawn evenly from +-scatter, eps_lock is the same for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.many_points import CORRECTION, Analysis, Rules, Run
from plyflow.evidence.stability.plane_mesh import Array, Mesh, block, series
from plyflow.evidence.stability.subject import Column, Subject, Values

COLUMN = Column("IM7-8552", 70.0)
SERIES_SCATTER = 0.05
Part = Sequence[float]
"""Elements across and high, scatter [%], kappa [MPa]."""


def mesh(check: Check, subject: Subject, scene: str, lock: str, part: Part, seed: int, plate: str = "frictionless") -> Outcome:
    """One mesh: the width at its end, or the increments where the plate is not frictionless.

    `lock` is an eps_lock or "A.1"; `plate` "frictionless" or "sticking", with "corrected" where the correction is tested.
    """
    across, high, scatter, kappa = part
    own = {} if lock == "A.1" else {"eps_lock": float(lock)}
    sticking, corrected = "sticking" in plate, "corrected" in plate
    body = block(int(across), int(high), sticking)
    run, eps_lock = pressed(subject, scene, body, scatter / 100.0, seed, {"kappa": kappa, **own}, corrected=corrected)
    if not run.finished:
        return check.refuse(f"stopped: {run.message}", **told(run))
    width = run.width * np.exp(eps_lock) - 1.0
    measured = run.increments if sticking else abs(width.mean())
    return check.judge(float(measured), f"width from {width.min():+.1e} to {width.max():+.1e}", **told(run))


def in_series(check: Check, subject: Subject, scene: str, number: int) -> Outcome:
    """Points that all carry the same force: increments beside those of a single one."""
    runs = [subject.once(_series, scene, n) for n in (number, 1)]
    for run in runs:
        if not run.finished or run.cutbacks["material"]:
            return check.fail(run.message or "the material asked for smaller increments", **told(run))
    return check.judge(runs[0].increments / runs[1].increments, **told(runs[0]))


def _series(subject: Subject, scene: str, number: int) -> Run:
    return pressed(subject, scene, series(number), SERIES_SCATTER, 1, {}, own=1)[0]


def pressed(
    subject: Subject, scene: str, body: Mesh, scatter: float, seed: int, settings: Values, own: int = 4, corrected: bool = False
) -> tuple[Run, float]:
    """Press a mesh by the whole programme: the run, and eps_lock [-].

    `own` points of each element have a k and h0 of their own; `settings` replace constants by name.
    """
    library, manifest = subject.scene(scene)
    values = subject.values(COLUMN) | settings
    props = scattered(subject.props(values), [p["name"] for p in manifest["props"]], own * len(body.elements), scatter, seed)
    rules = replace(Rules(), correction=CORRECTION) if corrected else Rules()
    load = COLUMN.case().load_programme
    return Analysis(library, body, props, len(manifest["statev"]), load, rules).run(), values["eps_lock"]


def scattered(props: Array, names: Sequence[str], count: int, scatter: float, seed: int) -> Array:
    """PROPS (count, n_props) with k and h0 drawn evenly from +-scatter [-] about their own."""
    random, result = np.random.default_rng(seed), np.tile(props, (count, 1))
    for name in ("k", "h0"):
        result[:, names.index(name)] *= 1.0 + scatter * random.uniform(-1.0, 1.0, count)
    return result


def told(run: Run) -> dict[str, float | int | str]:
    """Numbers of a run for its cell."""
    cut = ", ".join(f"{count} {reason}" for reason, count in sorted(run.cutbacks.items())) or "none"
    return {"increments": run.increments, "iterations": run.iterations, "cutbacks": cut, "plate": float(run.plate)}
