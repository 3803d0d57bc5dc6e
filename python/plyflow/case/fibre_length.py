"""What Eq. 5b would say of the larger specimen if the fibre length l0 grew with the width."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from plyflow.case.case import Case
from plyflow.case.programme import paper_programme
from plyflow.law import integrate


def length_dependence(case: Case) -> tuple[float, float]:
    """Final h/h0 [-] of a case with l0/d the same for every width, and with l0 in proportion to the width.

    b_bleed was fitted on the baseline specimen with 2 ln(l0/d) in it (b_squeeze - b_bleed), so with a longer fibre the bleed
    viscosity grows by the square of the ratio of the widths; the squeeze stage has no l0.
    """
    law, load = case.law(), case.load_programme
    longer = replace(law, l0_over_d=law.l0_over_d * case.width / paper_programme().specimen[0].width)
    same, grown = (float(integrate(one, load, [load.end]).thickness_ratio[0]) for one in (law, longer))
    return same, grown


def length_table(material: str = "IM7-8552", temperature: float = 70.0, **settings: float) -> pd.DataFrame:
    """Both ends of every layup of the scale-up specimen under the ramp-dwell load, a row each; see `length_dependence`."""
    programme = paper_programme()
    rows = []
    for layup in programme.plies_per_block:
        case = Case(material, temperature, layup, programme.specimen[-1].width, settings=settings)
        same, grown = length_dependence(case)
        rows.append({"layup": layup, "thickness_ratio_same_l0": same, "thickness_ratio_grown_l0": grown})
    return pd.DataFrame(rows)
