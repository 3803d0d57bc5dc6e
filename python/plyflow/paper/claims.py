"""The paper's claims as checks of the model's own numbers.

A check says what the model does, not what was measured: where only the measured points could decide, the verdict is
"cannot be judged" and the number says what the model predicts. The bounds are ours, since the paper gives none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial

import numpy as np
import pandas as pd

from plyflow.case.case import all_cases
from plyflow.case.programme import paper_programme
from plyflow.law import batch, integrate_batch

CASE = ("material", "temperature", "layup", "width")
NOTICEABLE = 0.01  # of h0 or w0: 20 to 26 um of the specimen's thickness
SETTLED = 0.4  # change for 10 K above 70 degC over that below
REACHED = 0.02  # distance to the compaction limit, h/h0
LITTLE_WIDENING, MARKED_WIDENING = 0.03, 0.05
BASELINE, SCALE_UP = 15.0, 30.0


def programme_table(settings: Mapping[str, float]) -> pd.DataFrame:
    """Final state of the 84 ramp-dwell cases by the one-dimensional law: what the claims look at.

    Returns
    -------
    pandas.DataFrame
        material, temperature [degC], layup, width [mm]; thickness = h/h0, limit = h/h0 at the compaction limit,
        widening = w/w0, locked, lock_time [s].
    """
    tables = []
    for specimen in paper_programme().specimen:
        cases = [replace(case, settings=settings) for case in all_cases() if case.width == specimen.width]
        laws = [case.law() for case in cases]
        load = cases[0].load_programme
        solution = integrate_batch(batch(laws), load, [load.end])
        state = {
            "thickness": solution.thickness_ratio[:, -1],
            "limit": [float(np.exp(law.eps_limit)) for law in laws],
            "widening": solution.width_ratio[:, -1],
            "locked": solution.locked[:, -1],
            "lock_time": solution.lock_time,
        }
        names = pd.DataFrame([{name: getattr(case, name) for name in CASE} for case in cases])
        tables.append(names.assign(**state))
    return pd.concat(tables, ignore_index=True)


def by_layup(table: pd.DataFrame, quantity: str) -> pd.DataFrame:
    """A quantity with a column a layup and a row a material, width and temperature."""
    return table.pivot_table(index=["material", "width", "temperature"], columns="layup", values=quantity)


def steps_of(table: pd.DataFrame, quantity: str, low: float, high: float) -> pd.Series:
    """Largest change of a quantity between neighbouring temperatures from low to high [degC], for each specimen kind."""
    inside = table[(table["temperature"] >= low) & (table["temperature"] <= high)]
    groups = inside.sort_values("temperature").groupby(["material", "layup", "width"])[quantity]
    return groups.apply(lambda values: float(np.max(np.abs(np.diff(values)))))


class Verdict(Enum):
    """What a check says of a claim."""

    HOLDS = "holds"
    FAILS = "does not hold"
    OPEN = "cannot be judged"


@dataclass(frozen=True)
class Finding:
    """Verdict on a claim, the number it rests on, and that number in words."""

    verdict: Verdict
    number: float
    words: str


@dataclass(frozen=True)
class Claim:
    """A claim: key, what the paper says and where, the criterion, the check of a programme table."""

    key: str
    text: str
    source: str
    criterion: str
    check: Callable[[pd.DataFrame], Finding]


def _finding(holds: bool, number: float, words: str) -> Finding:
    return Finding(Verdict.HOLDS if holds else Verdict.FAILS, float(number), words)


def limit_exists(table: pd.DataFrame) -> Finding:
    """Every case has a compaction limit above 0, and none goes beyond."""
    least, most = float(table["limit"].min()), float(table["limit"].max())
    above = float((table["thickness"] - table["limit"]).min())
    return _finding(least > 0.0 and above > 0.0, least, f"limits from {least:.3f} to {most:.3f} of h0")


def limit_varies(table: pd.DataFrame) -> Finding:
    """The limit differs between geometries at one temperature and between temperatures for one geometry."""
    geometry = table.groupby(["material", "temperature"])["limit"].agg(lambda values: values.max() - values.min())
    temperature = table.groupby(["material", "layup", "width"])["limit"].agg(lambda values: values.max() - values.min())
    number = min(float(geometry.min()), float(temperature.min()))
    words = (
        f"by {geometry.min():.3f} to {geometry.max():.3f} of h0 between geometries, "
        f"by {temperature.min():.3f} to {temperature.max():.3f} between temperatures"
    )
    return _finding(number > NOTICEABLE, number, words)


def limit_reached_by_thin_plies(table: pd.DataFrame) -> Finding:
    """Cross-ply specimens end at their limit."""
    thin = table[table["layup"] == "CP"]
    gap = float((thin["thickness"] - thin["limit"]).max())
    thick = table[table["layup"] == "BP"]
    blocked = float((thick["thickness"] - thick["limit"]).max())
    words = f"CP ends up to {gap:.3f} of h0 above its limit, BP up to {blocked:.3f}"
    return _finding(gap < REACHED, gap, words)


def converges(quantity: str, table: pd.DataFrame) -> Finding:
    """The limit or the thickness moves far less for 10 K above 70 degC than below, the worst kind of specimen."""
    above, below = steps_of(table, quantity, 70.0, 90.0), steps_of(table, quantity, 30.0, 70.0)
    if below.min() == 0.0:
        return Finding(Verdict.OPEN, 0.0, f"the {quantity} does not change with temperature here")
    ratio = above / below
    material, layup, width = ratio.idxmax()
    words = (
        f"above 70 degC up to {above.max():.3f} of h0 for 10 K, below up to {below.max():.3f}; "
        f"{int((ratio < SETTLED).sum())} of {len(ratio)} kinds settle, least {material} {layup} {width:g} mm"
    )
    return _finding(ratio.max() < SETTLED, ratio.max(), words)


def blocked_compacts_more(table: pd.DataFrame) -> Finding:
    """BP ends thinner than CP at every temperature."""
    pairs = by_layup(table, "thickness")
    gain = pairs["CP"] - pairs["BP"]
    return _finding(gain.min() > 0.0, gain.min(), f"BP ends {gain.min():.3f} to {gain.max():.3f} of h0 thinner")


def thin_widens_little(table: pd.DataFrame) -> Finding:
    """CP hardly widens."""
    growth = float(table.loc[table["layup"] == "CP", "widening"].max()) - 1.0
    return _finding(growth < LITTLE_WIDENING, growth, f"CP widens by at most {growth:.3f} of w0")


def blocked_widens_markedly(table: pd.DataFrame) -> Finding:
    """Baseline BP widens markedly above 70 degC, and more than CP."""
    warm = by_layup(table[(table["temperature"] >= 70.0) & (table["width"] == BASELINE)], "widening") - 1.0
    least, ratio = float(warm["BP"].min()), float((warm["BP"] / warm["CP"]).min())
    words = f"baseline BP widens by {least:.3f} to {warm['BP'].max():.3f} of w0, at least {ratio:.1f} times CP"
    return _finding(least > MARKED_WIDENING and ratio > 2.0, least, words)


def widening_settles(table: pd.DataFrame) -> Finding:
    """The width of BP does not change from 70 to 90 degC."""
    blocked = table[table["layup"] == "BP"]
    change = float(steps_of(blocked, "widening", 70.0, 90.0).max())
    return _finding(change < NOTICEABLE / 2.0, change, f"changes by at most {change:.4f} of w0 for 10 K above 70 degC")


def widening_rises_before(table: pd.DataFrame) -> Finding:
    """The width of BP rises between 30 and 70 degC, before the plateau."""
    blocked = table[(table["layup"] == "BP") & (table["width"] == BASELINE)]
    widths = blocked.pivot_table(index="material", columns="temperature", values="widening")
    rise = float((widths[70.0] - widths[30.0]).min())
    locked = int(table["locked"].sum())
    words = f"rises by {rise:.4f} of w0: {locked} of {len(table)} cases lock, and then the width no longer tells temperatures"
    return _finding(rise > NOTICEABLE, rise, words)


def merged_plies_explain(table: pd.DataFrame) -> Finding:
    """Merging plies alone makes a specimen thinner: 4 plies as one thinner than 2 as one, thinner than separate ones."""
    pairs = by_layup(table, "thickness")
    first, second = pairs["CP"] - pairs["SB"], pairs["SB"] - pairs["BP"]
    number = float(min(first.min(), second.min()))
    words = (
        f"2 plies as one end {first.min():.3f} to {first.max():.3f} of h0 thinner than separate ones, "
        f"4 as one {second.min():.3f} to {second.max():.3f} thinner than 2"
    )
    return _finding(number > 0.0, number, words)


def carried_to_scale_up(table: pd.DataFrame) -> Finding:
    """What the baseline parameters predict for the scale-up specimens; only their measurement could judge it."""
    sizes = table.pivot_table(index=["material", "layup", "temperature"], columns="width", values="thickness")
    change = sizes[SCALE_UP] - sizes[BASELINE]
    words = (
        f"scale-up is predicted {change.min():.3f} to {change.max():.3f} of h0 thicker than baseline; the measured "
        "thickness is not printed"
    )
    return Finding(Verdict.OPEN, float(change.max()), words)


CLAIMS: tuple[Claim, ...] = (
    Claim("limit", "A compaction limit exists.", "sections 2 and 5.2", "limit above 0, no case beyond it", limit_exists),
    Claim("limit-varies", "The limit varies with geometry and temperature.", "section 5.2",
          f"by more than {NOTICEABLE:g} of h0", limit_varies),
    Claim("limit-reached", "Thin cross-ply specimens reach their limit early.", "section 3.1",
          f"end within {REACHED:g} of h0 of it", limit_reached_by_thin_plies),
    Claim("limit-converges", "The limit converges above 70 degC.", "section 5.2",
          f"change for 10 K above less than {SETTLED:g} of that below, all kinds", partial(converges, "limit")),
    Claim("thickness-converges", "The thickness after the test converges above 70 degC.", "sections 2 and 5.2",
          f"change for 10 K above less than {SETTLED:g} of that below, all kinds", partial(converges, "thickness")),
    Claim("bp-thinner", "BP compacts more than CP at every temperature.", "section 2", "thinner in every pair",
          blocked_compacts_more),
    Claim("cp-width", "CP widens little.", "section 2", f"less than {LITTLE_WIDENING:g} of w0", thin_widens_little),
    Claim("bp-width", "BP widens markedly.", "section 2",
          f"baseline above 70 degC more than {MARKED_WIDENING:g} of w0 and twice CP", blocked_widens_markedly),
    Claim("bp-plateau", "The width of BP reaches a plateau around 70 degC.", "section 2",
          f"less than {NOTICEABLE / 2:g} of w0 for 10 K above", widening_settles),
    Claim("bp-rise", "Before the plateau, the width of BP rises with temperature.", "section 2",
          f"more than {NOTICEABLE:g} of w0 from 30 to 70 degC", widening_rises_before),
    Claim("merged", "Merged plies compact more than separate ones.", "section 3.2", "in every case", merged_plies_explain),
    Claim("scale-up", "Baseline parameters predict the scale-up specimens.", "section 5.3",
          "measured thickness, not printed in the paper", carried_to_scale_up),
)  # fmt: skip


def judge(table: pd.DataFrame, claims: Sequence[Claim] = CLAIMS) -> dict[str, Finding]:
    """Findings by claim, for the cases of a programme table."""
    return {claim.key: claim.check(table) for claim in claims}
