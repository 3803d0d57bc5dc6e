"""References of the creep-exact increment: the mean of the viscosity's power over the strain path, and what is made of it.

Written from the one-dimensional law (Eqs. 3 to 5), not from the model's expressions: every slope is a numeric derivative.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

import mpmath as mp

from umataudit.numbers import Number, Value, rounded
from umataudit.setting import Setting

Inputs = Mapping[str, Value]
Outputs = dict[str, Value]
PANELS = 8
SQUEEZE, BLEED = (3, 3), (0, 2)  # eta ~ (closeness^2 + first)/stretch^second
FLOWS = ("squeeze", "bleed", "cross")


def _shape(s: Number, limit: Number, plus: Number, power: Number) -> Number:
    return ((limit / (s - limit)) ** 2 + plus) / s**power


def mean(near: Number, far: Number, limit: Number, plus: Number, power: Number, exponent: Number) -> Number:
    """Mean of (eta/eta_near)^m near/s over the stretches s from near to far; its logarithm is linear in each of eight panels."""

    def rise(place: Number) -> Number:
        s = near + place * (far - near)
        return exponent * mp.log(_shape(s, limit, plus, power) / _shape(near, limit, plus, power)) - mp.log(s / near)

    total = mp.mpf(0)
    for left, right in pairwise((mp.mpf(i) / PANELS) ** 2 for i in range(PANELS + 1)):
        low, high = rise(left), rise(right)
        total += (right - left) * (mp.exp(low) if high == low else (mp.exp(high) - mp.exp(low)) / (high - low))
    return total


def integral(near: Number, far: Number, limit: Number, plus: Number, power: Number, exponent: Number) -> Number:
    """What `mean` stands for, by quadrature."""
    start = _shape(near, limit, plus, power)
    return mp.quad(lambda s: (_shape(s, limit, plus, power) / start) ** exponent * near / s, mp.linspace(near, far, 9)) / (far - near)


def _ratio(given: Inputs, end: Number) -> Number:
    """(eta_squeeze at the lock / eta_bleed at the end)^m, Eqs. 4 and 5 with sqrt(chi_f) exp(eps)/k = stretch/limit."""
    lock, limit, root_chi_l = given["lock_stretch"], given["stretch_limit"], mp.exp(-given["eps_lock"])
    squeeze = root_chi_l * mp.exp(given["b_squeeze"]) * _shape(lock, limit, *SQUEEZE)
    bleed = root_chi_l**2 * given["l0_over_d"] ** 2 * mp.exp(given["b_bleed"]) * _shape(end, limit, *BLEED)
    return (squeeze / bleed) ** given["exponent"]


def _joined(given: Inputs, end: Number, near: Number, far: Number) -> Number:
    lock, start = given["lock_stretch"], given["stretch_start"]
    return ((lock - end) * near + (start - lock) * end / lock * _ratio(given, end) * far) / (start - end)


def path_mean(given: Inputs, end: Number, flow: str) -> Number:
    """The mean from the end of the increment to its start, through the lock where that is passed."""
    start, limit, m = given["stretch_start"], given["stretch_limit"], given["exponent"]
    if flow != "cross":
        return mean(end, start, limit, *(SQUEEZE if flow == "squeeze" else BLEED), m)
    lock = given["lock_stretch"]
    return _joined(given, end, mean(end, lock, limit, *BLEED, m), mean(lock, start, limit, *SQUEEZE, m))


def along_the_path(known: Inputs, flow: str) -> tuple[Outputs, dict[str, Outputs]]:
    """What the point routine makes of the strain path between its blocks, and the inputs of its calls of `path` by prefix."""
    start, end, limit = rounded(mp.sqrt(known["x_start"])), known["stretch"], known["stretch_limit"]
    lock, m = rounded(mp.exp(known["eps_lock"])), rounded(1 / (known["a_rate"] + 1))
    delta = rounded(start / end - 1)
    log = mp.log(1 + delta)
    squeezing = flow == "squeeze"
    values = {
        "exponent": m, "stretch_start": start, "lock_stretch": lock, "delta": delta, "quotient": rounded(delta / log),
        "quotient_slope": rounded((log - delta / (1 + delta)) / log**2), "squeeze": mp.mpf(int(squeezing)),
        "across": rounded(1 / (1 + known["x_end"] ** 4)) if squeezing else mp.mpf(0),
    }  # fmt: skip
    whole = {"path": (end, start, SQUEEZE if squeezing else BLEED)}
    parts = {"near": (end, lock, BLEED), "far": (lock, start, SQUEEZE)} if flow == "cross" else whole
    paths = {
        name: {"near": near, "far": far, "stretch_limit": limit, "plus": mp.mpf(law[0]), "power": mp.mpf(law[1]), "exponent": m}
        for name, (near, far, law) in parts.items()
    }
    return values, paths


def path(given: Inputs, setting: Setting) -> Outputs:
    """The loop over the panels."""
    near, *rest = (given[name] for name in ("near", "far", "stretch_limit", "plus", "power", "exponent"))
    return {"mean": mean(near, *rest), "slope": mp.diff(lambda s: mean(s, *rest), near)}


def join(given: Inputs, setting: Setting) -> Outputs:
    """The two parts of a path through the lock, the near one moving with its given slope."""
    end = given["stretch"]

    def joined(s: Number) -> Number:
        return _joined(given, s, given["near_mean"] + given.get("near_slope", 0) * (s - end), given["far_mean"])

    slope = {"path_slope": mp.diff(joined, end)} if "near_slope" in given else {}
    return {"path_mean": joined(end), **slope}


def measures(delta: Number, quotient: Number, across: Number) -> tuple[Number, Number]:
    """Rates of C33 and C22 over twice that of eps, weighted by the share of C22 in A:A: first power and square."""
    u33 = (1 + delta / 2) * quotient
    u22 = u33 / (1 + delta) ** 2
    return (1 - across) * u33 + across * u22, (1 - across) * u33**2 + across * u22**2


def factor(path: Number, delta: Number, quotient: Number, across: Number, a: Number) -> tuple[Number, Number]:
    """R, by which g of the backward difference becomes that of the mean; and the rate in s over sqrt(J2/j2_unit)."""
    first, second = measures(delta, quotient, across)
    return (quotient * path) ** (a + 1) / second ** (a / 2) / first, first / mp.sqrt(second)


def creep(given: Inputs, setting: Setting) -> Outputs:
    """R with its slope by the stretch at the end, the mean effective stress and the power."""
    end, delta, a = given.get("stretch", mp.mpf(1)), given["delta"], given["a_rate"]

    def at(s: Number) -> tuple[Number, Number]:
        moved = (1 + delta) * end / s - 1
        quotient = given["quotient"] + given.get("quotient_slope", 0) * (moved - delta)
        across = given["across"] and 1 / (1 + (1 / given["across"] - 1) * (s / end) ** 8)
        return factor(given["path_mean"] + given.get("path_slope", 0) * (s - end), moved, quotient, across, a)

    def slope(which: int) -> Number:
        part: Callable[[Number], Number] = lambda s: mp.log(at(s)[which])  # noqa: E731
        return mp.diff(part, end)

    first, second = measures(delta, given["quotient"], given["across"])
    g, measure = given["g_flow"] * at(end)[0], at(end)[1]
    slopes = {"dlnr": slope(0), "dlnq": slope(1)} if "path_slope" in given else {}
    power = {"power": g * given["j2"] * first / second} if "j2" in given else {}
    if "eps_rate" in given:  # the mean rate of eps; at the end the rate goes with eta^-m under the same load
        mean_rate = given["eps_rate"] / ((1 + delta / 2) * given["quotient"])
        power["rate_slowed"] = mean_rate * given["quotient"] * given["path_mean"]
    mean_stress = g / given["det_f"] * mp.sqrt(given["j2_unit"] * given["j2_eff"]) * measure
    return {"g_mean": g, "mean_stress": mean_stress, **slopes, **power}


def load(given: Inputs, setting: Setting) -> Outputs:
    """G at the end of the increment, ln s extrapolated from the last one; s holds g/J, J2 and its unit, and the measure."""
    theta, squeeze = given["history"], given.get("squeeze", 0)
    beside: dict[str, Callable[[], Number]] = {
        "det_f": lambda: -given["dflow_det_f"], "stretch": lambda: given["dlnq"] + 2 * (1 - squeeze) / given["stretch"],
        "a_norm2": lambda: squeeze / (2 * given["a_norm2"]), "j2": lambda: 1 / (2 * given["j2_eff"]),
    }  # fmt: skip
    growth = (given["mean_stress"] / given["stress_last"]) ** theta
    result = {"g_visc": given["g_mean"] * growth}
    if "rate_slowed" in given:
        result["rate_end"] = given["rate_slowed"] * growth ** given["exponent"]
    for name in (name for name in beside if f"dflow_{name}" in given):
        own = given[f"dflow_{name}"] + (given["dlnr"] if name == "stretch" else 0)
        result[f"dlng_{name}"] = own + theta * (own + beside[name]())
    return result


REFERENCES = {"path": path, "join": join, "creep": creep, "load": load}
