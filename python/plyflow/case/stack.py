"""Fibre directions of a stack in laminate notation."""

from __future__ import annotations

import re
from itertools import groupby

from plyflow.case.programme import layup_text, paper_programme, plies_in_block
from plyflow.errors import InputError
from plyflow.wording import count_text


def stack_angles(text: str | None, layup: str) -> tuple[float, ...]:
    """Fibre directions [degrees from x] of the blocks of a layup, bottom to top.

    Parameters
    ----------
    text : str or None
        Directions of the plies in laminate notation, [90_4/0_4]_2 or 90,0,90,0 (a direction alone is a block);
        default the paper's: 90 and 0 in turn, 16 plies.

    Raises
    ------
    InputError
        No such notation; plies that are no pairs of blocks; a run of equal plies that is no whole number of blocks.
    """
    block = plies_in_block(layup)
    if text is None:
        whole = paper_programme().plies
        if whole % (2 * block):
            raise InputError(f"{whole} plies are no whole number of pairs of blocks of {block}; give the stack with --stack")
        return (90.0, 0.0) * (whole // (2 * block))
    inner = re.fullmatch(r"\s*\[(.*)\]\s*(?:_?(\d+))?\s*", text)
    body, times = (inner[1], int(inner[2] or 1)) if inner else (text, 1)
    entries = [re.fullmatch(r"\s*([+-]?\d+(?:\.\d+)?)(?:_(\d+))?\s*", entry) for entry in re.split("[/,]", body)]
    if not times or not all(entries):
        raise InputError(f"--stack {text}: write directions in degrees, bottom to top, as [90_4/0_4]_2 or 90,0,90,0")
    plies = [float(e[1]) for e in entries if e for _ in range(int(e[2] or (block if inner is None else 1)))] * times
    angles: list[float] = []
    for angle, run in groupby(plies):
        count = len(list(run))
        if count % block:
            raise InputError(
                f"--stack {text}: {count_text(count, 'ply', 'plies')} at {angle:g} degrees are no whole number of blocks of "
                f"{block} ({layup_text(layup)}); give a stack that fits, or another layup"
            )
        angles += [angle] * (count // block)
    if not angles:
        raise InputError(f"--stack {text}: no plies")
    return tuple(angles)
