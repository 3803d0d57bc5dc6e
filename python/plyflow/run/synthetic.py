"""A compaction test made from the law: what a perfect specimen would read, with noise if wanted.

It says in its first line that it was not measured.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case
from plyflow.case.materials import find_material
from plyflow.case.programme import paper_programme
from plyflow.case.solution import final_law, solve

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class SyntheticTest:
    """Readings of a specimen that follows the law.

    time (t,) [s], force (t,) [N], thickness of the specimen (t,) [mm], width of a block (t,) [mm]; of a cycle temperature (t,)
    [degC].
    """

    case: Case
    time: FloatArray
    force: FloatArray
    thickness: FloatArray
    width: FloatArray
    temperature: FloatArray | None = None

    def with_noise(self, thickness: float, force: float, seed: int) -> SyntheticTest:
        """The same readings with independent normal errors of standard deviation thickness [mm], force [N]."""
        source = np.random.default_rng(seed)
        forces = self.force + force * source.standard_normal(self.time.size)
        return replace(self, force=forces, thickness=self.thickness + thickness * source.standard_normal(self.time.size))

    def text(self) -> str:
        """The readings as a file that `plyflow identify` reads."""
        case = self.case
        lines = [
            "# made from the one-dimensional law by plyflow law1d: a synthetic test, not a measurement",
            f"# material: {find_material(case.material).name}",
            *([] if case.is_cycle else [f"# temperature: {case.temperature:g} degC"]),
            f"# layup: {case.layup}",
            f"# width: {case.width:g} mm",
            f"# ply thickness: {case.ply_thickness:.10g} mm",
            f"# plies: {paper_programme().plies if case.plies is None else case.plies}",
            "time [s],force [N],thickness [mm],width [mm]" + (",temperature [degC]" if case.is_cycle else ""),
        ]
        rows = zip(self.time, self.force, self.thickness, self.width, strict=True)
        told = [f"{time:.10g},{force:.10g},{thick:.12g},{wide:.10g}" for time, force, thick, wide in rows]
        heat = [] if self.temperature is None else [f",{one:.10g}" for one in self.temperature]
        lines += map(str.__add__, told, heat) if heat else told
        return "\n".join(lines) + "\n"


def synthetic_test(case: Case, every: float = 1.0) -> SyntheticTest:
    """Readings of a case each `every` seconds from 0 to the end of its load, without noise."""
    load = case.load_programme
    times = np.arange(0.0, load.end + 1e-9 * every, every)
    law, solution = final_law(case, load), solve([case], load, np.minimum(times, load.end)).row(0)
    return SyntheticTest(
        case,
        solution.time,
        solution.pressure * case.width**2,
        case.blocks * law.h0 * solution.thickness_ratio,
        law.w0 * solution.width_ratio,
        load.temperature(solution.time) if case.is_cycle else None,
    )
