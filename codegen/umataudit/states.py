"""Random admissible states for the comparison with machine code, and the chain of block calls at each of them."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath as mp

from umataudit.creep_blocks import FLOWS, along_the_path
from umataudit.creep_blocks import REFERENCES as OF_THE_INCREMENT
from umataudit.numbers import WORKING_DIGITS, Matrix, Number, Value, invariants, rounded
from umataudit.printed.tables import COLUMNS
from umataudit.setting import Scene, Setting
from umataudit.stress_blocks import REFERENCES as TO_THE_STRESS
from umataudit.stress_blocks import Inputs, Outputs, Reference
from umataudit.tangent_blocks import REFERENCES as OF_THE_TANGENT
from umatgen.model.temperature import cubics

Manifest = Mapping[str, Any]
_LETTERS = {
    "k": "k_gap", "a": "a_rate", "E_L": "e_l", "E_T": "e_t", "nu_LT": "nu_lt", "nu_TT": "nu_tt", "G_LT": "g_lt",
    **{f"{short}{i}": f"{name}_{i}" for short, name in (("n", "dir"), ("m", "nor")) for i in (1, 2, 3)},
}  # fmt: skip
_CLEAR = 0.003
PROPERTIES = {
    "w0": (10.0, 30.0), "h0": (0.1, 0.7), "l0_over_d": (3000.0, 5000.0), "eps_lock": (-0.1, -0.05),
    "chi_ratio": (0.65, 0.75), "e_l": (20.0, 30.0), "e_t": (0.5, 2.0), "nu_lt": (0.05, 0.3), "nu_tt": (0.1, 0.4),
    "g_lt": (0.5, 2.0), "kappa": (1.0e2, 1.0e4), "rate_floor": (1.0e-12, 1.0e-9), "strain_floor": (1.0e-13, 1.0e-11),
}  # fmt: skip
_REFERENCES = TO_THE_STRESS | OF_THE_INCREMENT | OF_THE_TANGENT


class UnknownBlockError(KeyError):
    """An emitted block has no registered equations."""


@dataclass(frozen=True)
class BlockCall:
    """One call of an emitted block.

    Parameters
    ----------
    name, equation : of the block, from the manifest.
    inputs : in the order of the argument list; double-precision numbers held exactly.
    expected : outputs in the order of the argument list, 30 digits.
    """

    name: str
    equation: str
    inputs: Inputs
    expected: Outputs


@dataclass(frozen=True)
class State:
    """Deformation gradients (3x3, the host's axes), time increment and constants.

    Parameters
    ----------
    flow : "squeeze", "bleed", or "cross" for an increment that passes the lock.
    past : mean stress of the last increment over that of the present one, and its length in s; None in a first increment.
    temperature : in degC, for constants from a table.
    """

    f0: Value
    f1: Value
    dt: Number
    properties: Mapping[str, Number]
    flow: str
    past: tuple[Number, Number] | None = None
    temperature: float = 0.0

    @property
    def given(self) -> dict[str, Value]:
        """What the point routine knows before its blocks, and the choices it makes between them, by symbol name."""
        p, squeezing = self.properties, self.flow == "squeeze"
        return {
            "f0": self.f0, "f1": self.f1, "dt_rate": self.dt, "per_time": 1 / self.dt, **p,
            "widening": mp.mpf(1), "in_plane": mp.mpf(int(self.flow != "cross")),
            "b_log": p["b_squeeze"] if squeezing else p["b_bleed"],
            "kappa_eff": p["kappa"] if squeezing else mp.mpf(0),
            "root_chi_l": rounded(mp.exp(-p["eps_lock"])),
            "kappa_held": mp.mpf(0) if squeezing else p["kappa"],
            "p_start": mp.mpf("0.25") if squeezing else mp.mpf(0),
            "j2_floor": max(p["rate_floor"], p["strain_floor"] / self.dt) ** 2,
            "history": mp.mpf(0) if self.past is None else self.dt / (self.dt + self.past[1]),
        }  # fmt: skip


def random_states(manifest: Manifest, count: int) -> list[State]:
    """`count` states, squeezing, bleeding and passing the lock in turn as far as a scene does, the same on every run.

    Notes
    -----
    Stretches around 1 along the fibre and compaction by a few percent; shears up to 0.1, or 0.02 where the printed
    invariants must be real. Every other round of states has a past.
    """
    scene = manifest["scene"]
    source = random.Random(f"states/{manifest['name']}")
    kept = scene.get("regimes", "both")
    flows = FLOWS if kept == "both" else (kept,)
    states: list[State] = []
    while len(states) < count:
        state = _state(source, scene, flows[len(states) % len(flows)], past=len(states) // len(flows) % 2 == 1)
        if _on_its_side_of_the_lock(state, Setting.of(scene)):
            states.append(state)
    return states


def _on_its_side_of_the_lock(state: State, setting: Setting) -> bool:
    """Whether both ends of the increment lie clearly before (squeeze) or after (bleed) the lock, or one on each side."""
    turn = setting.basis(state.properties)
    strains = [mp.log(invariants(mp.matrix(f) * turn, setting.compaction)["stretch"]) for f in (state.f0, state.f1)]
    start, end = (strain - state.properties["eps_lock"] for strain in strains)
    sides = {"squeeze": min(start, end), "bleed": -max(start, end), "cross": min(start, -end)}
    return bool(sides[state.flow] > _CLEAR)


def property_symbol(name: str) -> str:
    """Symbol name of a constant given by its name in the manifest."""
    return _LETTERS.get(name, name)


def _properties(source: random.Random, scene: Scene, temperature: float) -> dict[str, Number]:
    column = source.choice(COLUMNS)
    values = {name: source.uniform(*bounds) for name, bounds in PROPERTIES.items()}
    values |= {"k_gap": float(column.k), "a_rate": float(column.a)}
    values |= {"b_squeeze": float(column.b_squeeze), "b_bleed": float(column.b_bleed)}
    values |= {property_symbol(name): float(value) for name, value in scene.get("baked", ())}
    found = {name: mp.mpf(value) for name, value in values.items()}
    table = dict(scene.get("table", ()))
    for quantity in cubics(table, list(table)[1:]) if table else ():
        place = max(n for n, start in enumerate(table["temperature"][:-1]) if start <= temperature)
        found[quantity.name] = mp.polyval(quantity.coefficients[place], mp.mpf(temperature) - table["temperature"][place])
    return found


def _state(source: random.Random, scene: Scene, flow: str, past: bool) -> State:
    setting, shear = Setting.of(scene), 0.02 if scene.get("compaction") == "printed" else 0.1
    temperature = source.uniform(31.0, 89.0)
    dt, before = source.uniform(0.01, 10.0), (source.uniform(0.8, 1.25), source.uniform(0.01, 10.0))
    with mp.workdps(WORKING_DIGITS):
        properties = _properties(source, scene, temperature)
        properties |= {f"{name}_{i}": mp.mpf(source.uniform(0.2, 1.0)) for name in ("dir", "nor") for i in (1, 2, 3)}
        thickness = {"squeeze": 0.97, "bleed": 0.90, "cross": float(mp.exp(properties["eps_lock"])) * 1.015}[flow]
        middle, pushed = (1.0, 1.08, thickness), (1.0, 1.01, 0.97 if flow == "cross" else 0.985 if past else 1.0)
        turn = setting.basis(properties)
        start = turn * _near(source, middle, shear / 4, shear) * turn.T
        end = turn * _near(source, pushed, 1e-3, 1e-3) * turn.T * start
        f0, f1 = (rounded(_in_plane(f, setting).tolist()) for f in (start, end))
        return State(f0, f1, mp.mpf(dt), properties, flow, (mp.mpf(before[0]), mp.mpf(before[1])) if past else None, temperature)


def _near(source: random.Random, middle: tuple[float, float, float], along: float, shear: float) -> Matrix:
    rows = [[source.uniform(-1, 1) * (along if i == j else shear) for j in range(3)] for i in range(3)]
    return mp.diag(middle) + mp.matrix(rows)


def _in_plane(f: Matrix, setting: Setting) -> Matrix:
    """F without the shears out of the plane of axes 1 and 2, where a scene is plane."""
    return mp.matrix([[f[i, j] if setting.ntens == 6 or (i == 2) == (j == 2) else 0 for j in range(3)] for i in range(3)])


def reference(name: str) -> Reference:
    """What a block must return: a function of its inputs and of the scene's setting.

    Raises
    ------
    UnknownBlockError
        Names the block.
    """
    if name not in _REFERENCES:
        raise UnknownBlockError(f"block '{name}' has no registered equations; add a reference in umataudit")
    return _REFERENCES[name]


def block_calls(manifest: Manifest, states: Sequence[State]) -> Iterator[BlockCall]:
    """All blocks of a scene at all states; what a block's equations give, rounded, is what later blocks are given."""
    setting = Setting.of(manifest["scene"])
    with mp.workdps(WORKING_DIGITS):
        for state in states:
            known = state.given | {name: rounded(state.given[name]) for name in ("j2_floor", "per_time", "history")}
            for entry in _called(manifest["blocks"], state.flow):
                if entry["name"] in ("join", "creep") and "exponent" not in known:
                    yield from _along_the_path(known, state.flow, setting)
                yield _block_call(entry, known, setting)
                _between(known, state)


def _called(blocks: Sequence[Manifest], flow: str) -> Iterator[Manifest]:
    """The blocks that a state of this flow passes through."""
    others = ("bleed",) if flow == "squeeze" else ("squeeze",)
    for entry in blocks:
        if not entry["name"].endswith(others) and (entry["name"] not in ("join", "counted") or flow == "cross"):
            yield entry


def _block_call(entry: Manifest, known: dict[str, Value], setting: Setting) -> BlockCall:
    """The call of one block; `known` takes what it returns, rounded."""
    renamed = {"y_rate": "y_counted"} if entry["name"] == "gradient" and "y_counted" in known else {}
    inputs = {name: known[renamed.get(name, name)] for name in entry["inputs"]}
    outputs = reference(entry["name"])(inputs, setting)
    known |= {name: rounded(value) for name, value in outputs.items() if name not in inputs}
    given, expected = ({name: setting.kept(v[name]) for name in entry[key]} for key, v in (("inputs", inputs), ("outputs", outputs)))
    return BlockCall(entry["name"], entry["equation"], given, expected)


def _along_the_path(known: dict[str, Value], flow: str, setting: Setting) -> Iterator[BlockCall]:
    values, paths = along_the_path(known, flow)
    known |= values
    for name, inputs in paths.items():
        expected = reference("path")(inputs, setting)
        yield BlockCall("path", "3, 4, 5", inputs, expected)
        known |= {f"{name}_{key}": rounded(value) for key, value in expected.items()}


def _between(known: dict[str, Value], state: State) -> None:
    """What the point routine computes between its blocks."""
    if "g0" in known:
        known["f0"], known["f1"] = known.pop("g0"), known.pop("g1")
    known["j2_eff"] = rounded(known.get("j2", 0) + known["j2_floor"])
    if state.flow == "cross" and "x_start" in known:
        known["widening"] = rounded(mp.sqrt(known["x_start"]) / mp.exp(known["eps_lock"]))
    if "mean_stress" in known:
        known["stress_last"] = rounded(known["mean_stress"] * (state.past[0] if state.past else 1))
