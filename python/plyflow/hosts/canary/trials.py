"""The canary in the hosts that are here: what it says, and the iterations with each rate of its DDSDDE."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from plyflow.driver.drive import Controls, Step, UmatAddress, drive
from plyflow.errors import RunError
from plyflow.hosts.calculix.cubes import INHOMOGENEOUS
from plyflow.hosts.calculix.job import run_job
from plyflow.hosts.canary.files import PROPS, RATES, behaviour, calculix_face, card, manifest, umat
from plyflow.hosts.mgis.behaviour import compiled
from plyflow.hosts.mgis.opengeosys import Block, run_block
from plyflow.show.table import Column, Table

PRESSURE, INCREMENTS, DURATION = 1.5, 4, 20.0  # MPa, of the order of the moduli: else no rate makes a difference
HELD = 0.1  # compaction between plates that hold it
SHORTEST = 1 / 16  # of the longest increment
TIMEOUT = 60.0  # s
MOST = 60
HOSTS = ("driver", "CalculiX", "OpenGeoSys")
RUNS = len(HOSTS) * (len(RATES) + 1) + 1


@dataclass(frozen=True)
class Trial:
    """One run: host, rate of DDSDDE, iterations an increment (None: it did not finish), what the canary said."""

    host: str
    rate: int
    iterations: float | None
    said: tuple[str, ...]

    @property
    def rate_name(self) -> str:
        """The rate in words."""
        return RATES[self.rate]


def trials(folder: Path) -> Iterator[Trial]:
    """A pressed element with each rate; with the first one half an increment is asked for as well.

    Raises
    ------
    ToolError
        A host is missing.
    """
    run = {"driver": _driver, "CalculiX": _calculix, "OpenGeoSys": _opengeosys}
    for host in HOSTS:
        for rate in RATES:
            yield run[host](rate, folder / f"{host}_{rate}")
        asked = run[host](1, folder / f"{host}_ask", ask=True)
        yield Trial(f"{host}, half an increment asked for", 1, asked.iterations, asked.said)
    held = _opengeosys(1, folder / "OpenGeoSys_held", held=True)
    yield Trial("OpenGeoSys, F-bar, held", 1, held.iterations, held.said)


def _driver(rate: int, folder: Path, ask: bool = False) -> Trial:
    values = list((PROPS | {"rate": float(rate), "ask": float(ask)}).values())
    size = DURATION / INCREMENTS
    controls = Controls(
        initial_increment=size, maximum_increment=size, residual_tolerance=1e-12, newton="plain", extrapolation="none",
        max_iterations=MOST,
    )  # fmt: skip
    step = Step(DURATION, {"33": PRESSURE, "13": 0.1, "22": 0.0}, {"33": "P", "22": "S"})
    library = umat(folder / "canary.so")
    unheard = UmatAddress(library.address)  # the driver keeps the words of the last iteration alone
    history = drive(unheard, values, len(manifest()["statev"]), [step], controls)
    iterations = float(history.iterations[1:].mean()) if history.completed else None
    return Trial("driver", rate, iterations, _words(library.take_messages()[0]))


def _calculix(rate: int, folder: Path, ask: bool = False) -> Trial:
    face = calculix_face()
    twist = replace(INHOMOGENEOUS[0], increments=INCREMENTS)
    deck = twist.deck(card("calculix", face.material, rate, ask), face.material)
    deck = deck.replace("*STATIC, DIRECT", "*STATIC") if ask else deck
    try:
        result = run_job("canary", deck, [face], folder, must_finish=False, timeout=TIMEOUT)
        kept = result.increments[~result.increments["failed"]]
        iterations = float(kept["iterations"].mean()) if result.completed else None
    except RunError:
        iterations = None
    return Trial("CalculiX", rate, iterations, _words((folder / "canary.log").read_text(errors="replace")))


def _opengeosys(rate: int, folder: Path, ask: bool = False, held: bool = False) -> Trial:
    made = behaviour()
    cells = (2, 2, 2) if held else (1, 1, 1)
    load = 0.0 if held else PRESSURE
    block = Block("canary", cells, (1.0, 1.0, 1.0), HELD, load, f_bar=held, sticking=held, increments=INCREMENTS, shortest=SHORTEST)
    try:
        result = run_block(block, made, compiled(made), PROPS | {"rate": float(rate), "ask": float(ask)}, folder, TIMEOUT)
        iterations = float(result.iterations.mean())
    except RunError:
        iterations = None
    return Trial("OpenGeoSys", rate, iterations, _words((folder / "block.log").read_text(errors="replace")))


def _words(text: str) -> tuple[str, ...]:
    """What the canary said, without value, place and explanation."""
    return tuple(dict.fromkeys(re.split(r"[;:]", said)[0] for said in re.findall(r"canary: (.*?)\s*\(value", text)))


def table(found: Iterable[Trial]) -> Table:
    """The trials, a row each."""
    columns = (Column("host", wrap=True), Column("rate of DDSDDE"), Column("iterations", ".1f"), Column("the canary says", wrap=True))
    rows = [
        (one.host, one.rate_name, "no end" if one.iterations is None else one.iterations, "; ".join(one.said)) for one in found
    ]
    return Table(columns, rows, once="host")
