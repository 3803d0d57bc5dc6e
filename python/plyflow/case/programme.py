"""The paper's compaction programme: specimens, layups and load programmes (section 2)."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources

from pydantic import BaseModel, ConfigDict

from plyflow.errors import InputError
from plyflow.law.load import LoadProgramme
from plyflow.wording import count_text

LOADS = ("ramp-dwell", "monotonic")


class Specimen(BaseModel):
    """A square specimen: name, width [mm], force levels [N]."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    width: float
    levels: tuple[float, ...]


class Programme(BaseModel):
    """Times [s], plies per specimen, plies per block by layup, specimens."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    source: str
    plies: int
    total_time: float
    dwell_level_time: float
    ramp_time: float
    plies_per_block: dict[str, int]
    specimen: tuple[Specimen, ...]

    def force_levels(self, width: float) -> tuple[float, ...]:
        """Force levels [N] at a width [mm]: those of the specimen, else the baseline's pressures."""
        for specimen in self.specimen:
            if specimen.width == width:
                return specimen.levels
        baseline = self.specimen[0]
        return tuple(force * (width / baseline.width) ** 2 for force in baseline.levels)


@cache
def paper_programme() -> Programme:
    """Read the programme of section 2 of the paper."""
    file = resources.files("plyflow") / "data" / "programme.toml"
    return Programme.model_validate(tomllib.loads(file.read_text(encoding="utf-8")))


def plies_in_block(layup: str) -> int:
    """Equal plies in a block, for a layup of the programme or the number itself.

    Raises
    ------
    InputError
        Neither.
    """
    known = paper_programme().plies_per_block
    if layup.upper() in known:
        return known[layup.upper()]
    if layup.isascii() and layup.isdecimal() and int(layup) > 0:
        return int(layup)
    raise InputError(
        f"unknown layup '{layup}': choose one of {', '.join(known)}, or give the number of equal plies in a block"
    )


def layup_text(layup: str) -> str:
    """A layup for titles: a letter code as it is, a number of equal plies with the word."""
    return count_text(int(layup), "ply", "plies") if layup.isdecimal() else layup


def load_programme(load: str, width: float) -> LoadProgramme:
    """Plate pressure [MPa] over time [s] of a load of `LOADS`; plate area width x width [mm2], constant.

    "ramp-dwell": each level reached by a short ramp from the last, the first from 0, then held; "monotonic": from 0 to the
    last level in the total time.

    Raises
    ------
    InputError
        Unknown load.
    """
    programme = paper_programme()
    pressures = [force / (width * width) for force in programme.force_levels(width)]
    if load == "monotonic":
        return LoadProgramme((0.0, programme.total_time), (0.0, pressures[-1]))
    if load != "ramp-dwell":
        raise InputError(f"unknown load '{load}': choose one of {', '.join(LOADS)}")
    times, values = [0.0], [0.0]
    for level, pressure in enumerate(pressures):
        begin = level * programme.dwell_level_time
        times += [begin + programme.ramp_time, begin + programme.dwell_level_time]
        values += [pressure, pressure]
    return LoadProgramme(tuple(times), tuple(values))
