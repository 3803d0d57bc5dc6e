"""Every check of a claim gives each verdict it can give: on the model's table, and on one altered against it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from plyflow.case.case import Case
from plyflow.case.programme import load_programme
from plyflow.law import integrate
from plyflow.paper.claims import CLAIMS, Verdict, judge, programme_table
from plyflow.paper.claims_map import range_words, verdict_table

EXPECTED = {
    "limit": Verdict.HOLDS,
    "limit-varies": Verdict.HOLDS,
    "limit-reached": Verdict.FAILS,
    "limit-converges": Verdict.FAILS,
    "thickness-converges": Verdict.FAILS,
    "bp-thinner": Verdict.HOLDS,
    "cp-width": Verdict.FAILS,
    "bp-width": Verdict.HOLDS,
    "bp-plateau": Verdict.FAILS,
    "bp-rise": Verdict.HOLDS,
    "merged": Verdict.HOLDS,
    "scale-up": Verdict.OPEN,
}
Alteration = Callable[[pd.DataFrame], pd.DataFrame]


def settled(quantity: str) -> Alteration:
    """The quantity keeps above 70 degC the value it has at 70 degC."""

    def alter(table: pd.DataFrame) -> pd.DataFrame:
        ordered = table.sort_values("temperature")
        kept = ordered[quantity].where(ordered["temperature"] <= 70.0)
        filled = kept.groupby([ordered["material"], ordered["layup"], ordered["width"]]).ffill()
        return ordered.assign(**{quantity: filled})

    return alter


def narrow(table: pd.DataFrame) -> pd.DataFrame:
    """A tenth of the widening."""
    return table.assign(widening=1.0 + 0.1 * (table["widening"] - 1.0))


def one_case(change: Callable[[pd.DataFrame, int], None]) -> Alteration:
    def alter(table: pd.DataFrame) -> pd.DataFrame:
        altered = table.copy()
        change(altered, 20)  # IM7-8552, 90 degC, BP, 15 mm
        return altered

    return alter


def swapped(table: pd.DataFrame) -> pd.DataFrame:
    return table.assign(layup=table["layup"].replace({"CP": "BP", "BP": "CP"}))


def set_at(column: str, value: float) -> Alteration:
    return one_case(lambda table, row: table.__setitem__(column, table[column].where(table.index != row, value)))


ALTERED: list[tuple[str, Alteration, Verdict]] = [
    ("limit", set_at("thickness", 0.1), Verdict.FAILS),
    ("limit", lambda table: table.assign(limit=0.0), Verdict.FAILS),
    ("limit-varies", lambda table: table.assign(limit=0.7), Verdict.FAILS),
    ("limit-reached", lambda table: table.assign(thickness=table["limit"] + 0.01), Verdict.HOLDS),
    ("limit-converges", settled("limit"), Verdict.HOLDS),
    ("limit-converges", lambda table: table.assign(limit=0.7), Verdict.OPEN),
    ("thickness-converges", settled("thickness"), Verdict.HOLDS),
    ("bp-thinner", set_at("thickness", 0.9), Verdict.FAILS),
    ("cp-width", narrow, Verdict.HOLDS),
    ("bp-width", swapped, Verdict.FAILS),
    ("bp-width", set_at("widening", 1.02), Verdict.FAILS),
    ("bp-plateau", settled("widening"), Verdict.HOLDS),
    ("bp-rise", lambda table: table.assign(widening=1.06), Verdict.FAILS),
    ("merged", set_at("thickness", 0.9), Verdict.FAILS),
]


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return programme_table({})


def test_the_table_is_the_law(table: pd.DataFrame) -> None:
    assert len(table) == 84

    def error(row: dict[str, float], altered: float = 0.0) -> float:
        case = Case(row["material"], row["temperature"], row["layup"], row["width"])
        history = integrate(case.law(), load_programme("ramp-dwell", row["width"]), [1200.0])
        wanted = np.array([history.thickness_ratio[0], history.width_ratio[0], history.lock_time])
        found = np.array([row["thickness"] + altered, row["widening"], row["lock_time"]])
        return float(np.max(np.abs(found / wanted - 1.0)))

    rows = table.iloc[::17].to_dict("records")
    assert max(error(row) for row in rows) < 1e-7
    assert error(rows[0], altered=1e-5) > 1e-6


def test_verdicts_on_the_model(table: pd.DataFrame) -> None:
    findings = judge(table)
    assert {key: finding.verdict for key, finding in findings.items()} == EXPECTED
    assert findings["limit"].number == pytest.approx(table["limit"].min())
    assert findings["bp-width"].number == pytest.approx(0.15056, abs=1e-5)  # exp(-eps_lock) - 1 of IM7-8552, Eq. 6
    assert findings["limit-reached"].number == pytest.approx(0.19291, abs=1e-4)


@pytest.mark.parametrize(("key", "alter", "verdict"), ALTERED, ids=[f"{a[0]}-{n}" for n, a in enumerate(ALTERED)])
def test_an_altered_table_turns_the_verdict(
    table: pd.DataFrame, key: str, alter: Alteration, verdict: Verdict
) -> None:
    assert judge(alter(table))[key].verdict is verdict is not EXPECTED[key]


def test_every_claim_that_can_be_judged_was_turned() -> None:
    assert {key for key, _, _ in ALTERED} == {claim.key for claim in CLAIMS} - {"scale-up"}


def test_the_map_agrees_with_single_points_and_shows_what_depends() -> None:
    rows = verdict_table({})
    assert len(rows) == 8 * 5 * len(CLAIMS)
    here = rows[(rows["gamma_lock"] == 80.0) & (rows["l0_over_d"] == 4294.0)].set_index("claim")
    given = judge(programme_table({"gamma_lock": 80.0}))
    assert dict(here["verdict"]) == {key: finding.verdict.value for key, finding in given.items()}
    there = judge(programme_table({"gamma_lock": 45.0, "l0_over_d": 8588.0}))
    point = rows[(rows["gamma_lock"] == 45.0) & (rows["l0_over_d"] == 8588.0)].set_index("claim")
    assert dict(point["verdict"]) == {key: finding.verdict.value for key, finding in there.items()}
    assert point["verdict"]["bp-width"] != here["verdict"]["bp-width"]
    words = range_words(rows)
    assert words["bp-width"].startswith("holds at 15 of 40 points (gamma_lock 80 to 86 deg)")
    assert words["bp-rise"].startswith("holds nowhere")
    assert words["limit"].startswith("holds throughout")
    assert words["scale-up"].startswith("open throughout")
