"""The Abaqus host face: SUBROUTINE UMAT with its 37 arguments, the point routine and the procedures of all stages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.fortran.checks import applicable
from umatgen.fortran.faults import fault_texts, left_out
from umatgen.fortran.interface import (
    HISTORY,
    PROPERTIES,
    properties,
    property_rows,
    state_rows,
    state_variables,
    table_quantities,
)
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import block_lines, decimal, expression
from umatgen.fortran.procedures import block_of, call_text
from umatgen.lower.stage import Stage
from umatgen.model import law_1d, lock
from umatgen.model.rates import rate_formula
from umatgen.model.temperature import QUANTITIES, cubics
from umatgen.notation import sym
from umatgen.scene import Scene

_UNUSED = [
    "STRAN",
    "DSTRAN",
    "TEMP",
    "DTEMP",
    "PREDEF",
    "DPRED",
    "COORDS",
    "DROT",
    "CELENT",
    "LAYER",
    "KSPT",
    "SPD",
    "RPL",
    "DDSDDT",
    "DRPLDE",
    "DRPLDT",
]
_SLOPES = ("det_f", "stretch", "a_norm2", "j2")


def source(scene: Scene, stages: Sequence[Stage]) -> str:
    """Text of the source file of a scene."""
    prefix = f"pf_{scene.name}_"
    environment = Environment(
        loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined, trim_blocks=False
    )
    template = environment.get_template("abaqus_umat.f.j2")
    text = template.render(**_interface(scene, stages), **_point(scene, stages, prefix), prefix=prefix, scene=scene)
    lines = text.splitlines()
    procedures = [line for stage in stages for line in ("", *block_lines(block_of(stage), prefix))]
    place = lines.index("!@stages") if "!@stages" in lines else len(lines)
    return lay_out([*lines[:place], *procedures, *lines[place + 1 :]], both_forms=scene.layout == "both")


def unsymmetric(scene: Scene) -> bool:
    """Whether DDSDDE is unsymmetric, so that *USER MATERIAL wants UNSYMM."""
    return scene.tangent == "consistent"


def _interface(scene: Scene, stages: Sequence[Stage]) -> dict[str, Any]:
    """What the header, the subroutine UMAT, the checks and the report need."""
    used, kept = properties(scene, stages), state_variables(scene)
    places = {p.name: f"props({i})" for i, p in enumerate(used, 1)}
    symmetry = {"consistent": "DDSDDE is not symmetric: *USER MATERIAL, UNSYMM.", "none": "DDSDDE is not computed."}
    axis = "Fibre along n1, n2, n3 of PROPS." if scene.fibre == "free" else f"Fibre along material axis {scene.fibre}."
    actual = ["DFGRD0", "DFGRD1", "DTIME", *([] if scene.baked else ["PROPS"])]
    actual += [*(["KINC"] if scene.two_step else []), *(["TEMP + DTEMP"] if scene.table else []), *_inout(scene, upper=True)]
    return {
        "version": __version__,
        "fibre_text": axis,
        "symmetry_text": symmetry.get(scene.tangent, "DDSDDE is symmetric."),
        "left_out": left_out(scene),
        "plane": scene.ntens == 4,
        "n": scene.ntens,
        "props": property_rows(used),
        "statev": state_rows(kept),
        "state": kept,
        "place": {s.name: i for i, s in enumerate(kept, 1)},
        "property_names": [(i, p.fortran) for i, p in enumerate(used, 1)],
        "checks": applicable(places),
        "checked": scene.checks,
        "faults": fault_texts(scene, places),
        "baked": bool(scene.baked),
        "baked_values": _baked_values(scene, used),
        "unused": _unused(scene),
        "point_actual": ", ".join([*actual, "ifault", "fault_value", "fault_bound"]),
    }


def _baked_values(scene: Scene, used: Sequence[Any]) -> list[tuple[str, str]]:
    values = dict(scene.baked)
    return [(p.fortran, decimal(values[p.name])) for p in used] if scene.baked else []


def _inout(scene: Scene, upper: bool = False) -> list[str]:
    """Arguments of the point routine that it changes, in order."""
    names = (["statev"] if state_variables(scene) else []) + ["stress"]
    names += ["ddsdde"] if scene.tangent != "none" else []
    names += ["sse", "scd"] if scene.energies else []
    names += ["pnewdt"] if _asks(scene) else []
    names += ["ddsddt"] if scene.table else []
    return [name.upper() for name in names] if upper else names


def _lands(scene: Scene) -> bool:
    """Whether increments are made to end at the lock."""
    return scene.lock == "instant" and scene.regimes != "bleed"


def _asks(scene: Scene) -> bool:
    """Whether the point routine itself asks for smaller increments."""
    return _lands(scene) or scene.lock == "blend"


def _unused(scene: Scene) -> list[str]:
    """ASSOCIATE lists of the dummies of UMAT that a scene does not use."""
    names = [name for name in _UNUSED if not (scene.table and name in ("TEMP", "DTEMP", "DDSDDT"))]
    names += [] if scene.energies else ["SSE", "SCD"]
    names += ["PROPS", "NPROPS"] if scene.baked else []
    names += ["DDSDDE"] if scene.tangent == "none" else []
    names += [] if state_variables(scene) else ["STATEV"]
    return [
        ", ".join(f"unused_{i} => {name}" for i, name in enumerate(names[first : first + 6], 1))
        for first in range(0, len(names), 6)
    ]


def _point(scene: Scene, stages: Sequence[Stage], prefix: str) -> dict[str, Any]:
    """What the point routine needs."""
    by_name = {stage.name: stage for stage in stages}
    turned = {"f0": "g0", "f1": "g1"} if scene.fibre == "free" else {}
    renamed = {name: {} if name == "frame" else turned for name in by_name}
    if scene.two_step:
        renamed |= {name: {"dt": "dt_rate"} for name in ("gradient", "tangent") if name in by_name}
    calls = {name: call_text(stage, prefix, **renamed[name]) for name, stage in by_name.items()}
    optional = ("frame", "start", "moduli", "elastic", "gradient", "lock_gradient", "tangent", "blend")
    n = scene.ntens
    shapes = {"statev": f"{len(state_variables(scene))}", "stress": f"{n}", "ddsdde": f"{n},{n}", "ddsddt": f"{n}"}
    inout = [f"{name}({shapes[name]})" if name in shapes else name for name in _inout(scene)]
    first = ["f0", "f1", "dt", *([] if scene.baked else ["props"]), *(["kinc"] if scene.two_step else [])]
    first += ["theta"] if scene.table else []
    arrays, scalars = _locals(scene, stages)
    return {
        "calls": dict.fromkeys(optional, "") | calls,
        "flow": _flow_calls(scene, by_name, prefix),
        "printed": _printed_calls(scene, by_name, prefix),
        "text": _texts(),
        "kept": scene.kept_regimes,
        "both": scene.both_regimes,
        "blend": scene.lock == "blend",
        "landing": _lands(scene),
        "free": scene.fibre == "free",
        "volume": scene.has_volume,
        "augmented": scene.incompressibility == "augmented" and scene.has_volume,
        "internal": scene.procedures == "internal",
        "last_rate": scene.keeps_last_rate,
        "two_step": scene.two_step,
        "history": [state_place(scene, s.name) for s in HISTORY if state_place(scene, s.name)],
        "rate_slope": expression(rate_formula(scene.integrator).slope),
        "thermal": _thermal(scene),
        "needs_eps": _needs_eps(scene),
        "tolerance": decimal(scene.landing_tolerance),
        "width": decimal(scene.blend_width),
        "point_dummies": ", ".join([*first, *_inout(scene), "ifault", "fault_value", "fault_bound"]),
        "point_inout": ", ".join(inout),
        "arrays": ", ".join(arrays),
        "scalars": ", ".join(scalars),
    }


def state_place(scene: Scene, name: str) -> int:
    """Number of a state variable, 0 where the scene does not keep it."""
    names = [s.name for s in state_variables(scene)]
    return names.index(name) + 1 if name in names else 0


def _needs_eps(scene: Scene) -> bool:
    return scene.lock == "blend" or scene.outputs == "full"


def _flow_calls(scene: Scene, stages: dict[str, Stage], prefix: str) -> dict[str, str]:
    """Calls of the flow stages with the names that the scene gives their arguments."""
    calls = {}
    for name in scene.kept_regimes:
        rename = {}
        if scene.lock == "blend":
            rename = {"b_log": f"b_{name}", "g_visc": f"g_{name}"}
            rename |= {f"dlng_{v}": f"dlng{name[0]}_{v}" for v in _SLOPES}
        if scene.invariants == "printed":
            rename |= {"stretch": "p_stretch", "a_norm2": "p_norm2"}
        calls[name] = call_text(stages[name], prefix, **rename)
    return calls


def _printed_calls(scene: Scene, stages: dict[str, Stage], prefix: str) -> dict[str, str]:
    names = scene.kept_regimes if scene.invariants == "printed" else ()
    return {"squeeze": "", "bleed": ""} | {name: call_text(stages[f"printed_{name}"], prefix) for name in names}


def _texts() -> dict[str, str]:
    """Scalar expressions of the point routine, from the model."""
    j2_eff, a_rate = sym("j2_eff", "a_rate")
    bleed_ratio = lock.G_BLEED / lock.G_SQUEEZE
    return {
        "window": expression(lock.window_position()),
        "smoothstep": expression(lock.smoothstep(lock.XI)),
        "slope": expression(lock.slope_of_step()),
        "rate_ratio": f"(j2_last/{j2_eff})**({expression(a_rate / 2)})",
        "blend_ratio": expression(lock.blended_factor().expr.subs(lock.G_SQUEEZE, 1).subs(lock.G_BLEED, bleed_ratio)),
        "eta_ratio": expression(law_1d.squeeze_viscosity_ratio()),
    }


def _locals(scene: Scene, stages: Sequence[Stage]) -> tuple[list[str], list[str]]:
    """Local arrays and scalars of the point routine: outputs of the stages, properties, and the routine's own."""
    dummies = {"f0", "f1", "g0", "g1", "dt", "stress", "ddsdde"}
    arrays: list[str] = []
    scalars = [] if scene.baked else [p.fortran for p in properties(scene, stages)]
    for stage in stages:
        for variable in stage.outputs:
            if variable.name in dummies:
                continue
            if variable.shape:
                arrays.append(f"{variable.name}({','.join(map(str, variable.shape))})")
            else:
                scalars.append(variable.name)
    arrays += [f"rate_last({scene.ntens})"] if scene.two_step else []
    known = {p.fortran for p in PROPERTIES} - set(scalars) - {QUANTITIES[n] for n in table_quantities(scene)}
    scalars = [name for name in dict.fromkeys([*scalars, *_own_locals(scene, stages)]) if name not in known]
    return list(dict.fromkeys(arrays)), scalars


def _thermal(scene: Scene) -> dict[str, Any]:
    """Temperatures and cubics of a table, as Fortran text; nothing without one."""
    if not scene.table:
        return {}
    table = dict(scene.table)
    found = cubics(table, table_quantities(scene))
    values = {c.name: [", ".join(decimal(x) for x in piece) for piece in c.coefficients] for c in found}
    return {
        "marks": [decimal(t) for t in table["temperature"]],
        "cubics": {name: ", ".join(pieces) for name, pieces in values.items()},
        "names": list(values),
        "results": ", ".join([*values, *(f"d{name}" for name in values)]),
    }


def _own_locals(scene: Scene, stages: Sequence[Stage]) -> list[str]:
    """Scalars that the point routine itself sets."""
    names = ["j2_floor", "j2_eff"] + (["eps"] if _needs_eps(scene) else [])
    names += ["kappa_eff"] if scene.has_volume else []
    names += ["power"] if scene.energies else []
    names += ["j2_last"] if scene.keeps_last_rate or scene.two_step else []
    if scene.table:
        names += [QUANTITIES[n] for n in table_quantities(scene)]
        names += [f"d{QUANTITIES[n]}" for n in table_quantities(scene)] + ["db_log", "dlng_dtheta"]
    names += ["history", "dt_last"] if scene.two_step else []
    names += ["dt_rate"] if scene.two_step and scene.tangent != "none" else []
    if scene.lock == "blend":
        names += ["xi", "s_start", "eps_start", "fraction", "s_lock", "ds_dstretch", "g_squeeze", "g_bleed", "chord"]
        return names + [f"dlng{x}_{v}" for x in "sb" for v in _SLOPES]
    names += ["b_log"]
    names += ["lock_stretch", "fraction", "chord"] if _lands(scene) else []
    return names + (["p_start"] if scene.incompressibility == "augmented" and scene.has_volume else [])
