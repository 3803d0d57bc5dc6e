"""How the verdicts change over the range of what the paper leaves open: gamma_lock and l0/d."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from plyflow.paper.claims import CLAIMS, Verdict, judge
from plyflow.paper.programme_table import programme_table

# Edge shear from small to nearly a right angle; fibre length over width from 15 mm / 7 um to 60 mm / 7 um.
GAMMA_LOCK = (45.0, 60.0, 70.0, 75.0, 80.0, 83.0, 86.0, 88.0)
L0_OVER_D = (2147.0, 3036.0, 4294.0, 6073.0, 8588.0)


def verdict_table(settings: Mapping[str, float]) -> pd.DataFrame:
    """Verdict and number of every claim over the grid of gamma_lock [deg] and l0/d [-]; other settings as given."""
    rows = []
    for gamma_lock in GAMMA_LOCK:
        for l0_over_d in L0_OVER_D:
            table = programme_table({**settings, "gamma_lock": gamma_lock, "l0_over_d": l0_over_d})
            for key, finding in judge(table).items():
                rows.append(
                    {
                        "claim": key,
                        "gamma_lock": gamma_lock,
                        "l0_over_d": l0_over_d,
                        "verdict": finding.verdict.value,
                        "number": finding.number,
                    }
                )
    return pd.DataFrame(rows)


def range_words(table: pd.DataFrame) -> dict[str, str]:
    """How each claim fares over the grid, in words, by key."""
    words = {}
    for claim in CLAIMS:
        rows = table[table["claim"] == claim.key]
        holding = rows[rows["verdict"] == Verdict.HOLDS.value]
        low, high = rows["number"].min(), rows["number"].max()
        number = f"number from {low:.3g} to {high:.3g}"
        if (rows["verdict"] == Verdict.OPEN.value).all():
            words[claim.key] = f"open throughout, {number}"
        elif holding.empty:
            words[claim.key] = f"holds nowhere, {number}"
        elif len(holding) == len(rows):
            words[claim.key] = f"holds throughout, {number}"
        else:
            words[claim.key] = f"holds at {len(holding)} of {len(rows)} points ({_where(rows, holding)}), {number}"
    return words


def _where(rows: pd.DataFrame, holding: pd.DataFrame) -> str:
    parts = []
    for name, unit in (("gamma_lock", " deg"), ("l0_over_d", "")):
        kept = sorted(holding[name].unique())
        if len(kept) < rows[name].nunique():
            parts.append(f"{name} {kept[0]:g} to {kept[-1]:g}{unit}")
    return ", ".join(parts) if parts else "gamma_lock and l0/d together"
