"""The report of a bench session as a page."""

from __future__ import annotations

import statistics
from typing import Any

from plyflow.evidence.bench.accuracy import MARGIN, TARGET, cost_at, front, median_seconds, over, pick, umat_calls
from plyflow.evidence.bench.generation import LIMITS
from plyflow.evidence.bench.peers.fortran import TWIN
from plyflow.evidence.bench.problems import FAMILIES, QUANTITIES, SPEED_DURATION, SPEED_THICKNESS
from plyflow.evidence.bench.schemes import DEFAULT, PAPER, PAPER_REAL, Scheme
from plyflow.evidence.bench.session import NOT_SHOWN, Session
from plyflow.evidence.bench.spread import spread_of
from plyflow.show.page import Block, Details, Items, Page, Picture, Section
from plyflow.show.table import Column, Table

BUSY = 0.2  # spread of one combination in ten from which the machine counts as busy
PEER_CONTROLS = ("growth 0.3", "largest 20", "largest 120", "equal 30")
MS, US = Column("CPU time", ".2f", "ms"), Column("a call, driver included", ".2f", "us")
CALLS, INCREMENTS, ERROR = Column("calls", ".0f"), Column("increments", "d"), Column("error", ".1e")


def page(session: Session) -> Page:
    """The whole report."""
    lead = (
        f"The recommendation is the scene with open constants that reaches {TARGET:g} in final thickness in the least run time "
        f"(geometric mean over the programmes) and keeps the width to {TARGET:g}; the default one stays unless beaten by more "
        f"than {100 * (1 - MARGIN):.0f} %. The paper's scheme is bdf1 with the tangent of Eq. 16; '{PAPER}' has the invariants "
        f"of Eqs. 13-14 in I1 and I3 (the scene 'printed' has them too, with a tangent of its own), the scene '{PAPER_REAL}' "
        "the same ones where they are always real."
    )
    inputs = [f"{p.name}: {p.label}. " + "; ".join(f"{n} = {v:g}" for n, v in session.values[p.name].items())
              for p in session.problems]  # fmt: skip
    blocks: list[Block] = [
        Items(session.verdict()), _target(session), _figures(session), _peers(session), _exactness(session), _costs(session),
        Section("Uncertainty", [Items(_uncertainty(session))]),
        Section("Scenes that take no part", [Table(["scene", Column("why", wrap=True)], session.left_out.items())]),
        Section("Inputs", [Items(inputs)]), Section("All runs", [Details("Every combination", [_points(session)])]),
    ]  # fmt: skip
    assumptions = [f"{p.name}: {line}" for p in session.problems for line in session.assumptions(p)]
    return Page("Work-precision", lead, blocks, assumptions=assumptions, limits=NOT_SHOWN, provenance=session.machine)


def _target(session: Session) -> Section:
    groups = [(MS, Column("x default", ".2f"), CALLS)] * len(session.loads)
    columns = [Column(c.heading, c.format, c.unit, over=name) for name, own in zip(session.loads, groups, strict=True) for c in own]
    rows = [[scheme.name, *scheme.traits.values(), *(entry for name in session.loads for entry in _reached(session, scheme, name))]
            for scheme in session.schemes]  # fmt: skip
    words = (
        "Processor time of the whole programme, its ratio to the default scene, calls of the UMAT; best step control, read between "
        "the points in logarithms."
    )
    table = Table(["scheme", "tangent", "integrator", "Newton", *columns], rows)
    return Section(f"What {TARGET:g} in final thickness costs", [words, table])


def _reached(session: Session, scheme: Scheme, problem: str) -> list[Any]:
    mine, base = (pick(session.points, problem, name) for name in (scheme.name, DEFAULT))
    time, calls = (cost_at(mine, cost) for cost in (median_seconds, umat_calls))
    if time is None:
        return ["not reached" if mine else "not run", None, None]
    return [1e3 * time, over(time, cost_at(base, median_seconds)), calls]


def _figures(session: Session) -> Section:
    pictures, rows = [], []
    for problem in session.problems:
        mine = [p for p in session.points if p.problem == problem.name]
        for quantity in problem.quantities:
            pictures.append(Picture(session.figures[f"{problem.name}-{quantity}.svg"], f"{problem.label}: {QUANTITIES[quantity]}"))
            rows += [[f"{problem.name}, {quantity}", p.scheme, p.control, 1e3 * p.time.median, p.increments, p.errors[quantity]]
                     for p in front(mine, quantity, median_seconds)]  # fmt: skip
    families = "; ".join(f"{name}: {words}" for name, words in FAMILIES.items())
    words = f"Step controls: {families} (tolerance dotted). Below: the fronts over processor time, cheapest first."
    fronts = Table(["front", "scheme", "control", MS, INCREMENTS, ERROR], rows)
    return Section("Error against run time and increments", [words, *pictures, Details("What lies on the fronts", [fronts])])


def _peers(session: Session) -> Section:
    rows: list[list[Any]] = []
    peers = [scheme.name for scheme in session.schemes if scheme.kind == "peer"]
    for point in session.points:
        twin = [p for p in pick(session.points, point.problem, TWIN) if p.control == point.control]
        if point.scheme in peers and twin and point.control in PEER_CONTROLS:
            time = point.time.median
            took = [1e3 * time, time / twin[0].time.median, 1e6 * time / point.umat_calls] if point.completed else [point.message]
            rows.append([point.problem, point.control, point.scheme, *took, *[None] * (3 - len(took)), point.umat_calls,
                         twin[0].umat_calls])  # fmt: skip
    words = (
        f"The material of the scene {TWIN} behind the same driver: 'perturbed' takes DDSDDE from forward differences of 1e-8, "
        "'four_index' pushes a fourth-order tensor forward index by index, 'tensortrax' differentiates the potentials written in "
        "NumPy."
    )
    figures = (MS, Column(f"x {TWIN}", ".1f"), US, CALLS, Column(f"calls of {TWIN}", "d"))
    return Section("Peers", [words, Table(["problem", "control", "peer", *figures], rows)])


def _exactness(session: Session) -> Section:
    found = session.rounding
    stays = [
        f"{name}: at vanishing increments the final thickness stays {distance:.1e} (relative, extrapolated) from the law: "
        "elasticity and penalty, which the law has not."
        for name, distance in session.distances.items()
    ]
    lines = [
        "Reference: the one-dimensional law at a relative tolerance of 1e-13.",
        f"Rounding: along {found.increments} increments of the first problem the double-precision stress is off the "
        f"quadruple-precision one by {found.stress[0]:.1e} (median), {found.stress[1]:.1e} (worst), DDSDDE by "
        f"{found.ddsdde[0]:.1e} and {found.ddsdde[1]:.1e}, relative to the largest entry.",
        *stays,
        "Width: the increment that passes the lock counts its rate from the width there, so viscosity takes a free edge to it "
        "whatever the increment.",
        f"Plate speed: h/h0 falls from 1 to {SPEED_THICKNESS:g} in {SPEED_DURATION:g} s; the law's stress has no elastic "
        "part, which is the floor of that error.",
    ]
    return Section("What the errors rest on", [Items(lines)])


def _costs(session: Session) -> Section:
    """Batch rate, instructions, generation."""
    alone, cost = session.rates[1], session.generation
    rates = [[n, *(f / 1e6 for f in (spread.median, spread.half)), spread.median / spread_of(alone).median, max(own) / 1e6,
              max(own) / max(alone)] for n, own in session.rates.items() for spread in [spread_of(own)]]  # fmt: skip
    heads = ("million calls/s", "spread", "x 1 thread", "best", "x 1 thread, best")
    mine = [p for p in session.points if p.scheme == DEFAULT and p.completed]
    per_call = statistics.median(min(p.seconds) / p.umat_calls for p in mine)
    counts = [[name, "no valgrind" if n is None else n] for name, n in session.instructions.items()]
    first, *others = cost.cold
    return Section("Costs beside the runs", [
        f"Batch entry, default scene, {session.batch_points} points a batch, in blocks of eight, through Python:",
        Table([Column("threads", "d"), *(Column(head, ".2f") for head in heads)], rates),
        f"A call of the default scene takes {1e6 / max(alone):.2f} us in the batch and {1e6 * per_call:.2f} us in the runs above "
        "(best), driver and solution included: the driver's share dilutes what a cheaper UMAT gains in run time.",
        "Instructions a call, both stages averaged, empty loop subtracted (callgrind, gfortran -O2):",
        Table(["scheme", Column("instructions", ".0f")], counts),
        f"Generation in a fresh process, processor time ({cost.start:.1f} s to start Python's modules): '{first}' "
        f"{cost.cold[first]:.2f} s cold (limit {LIMITS['cold']:g}), any other scene at most "
        f"{max(cost.cold[name] for name in others):.2f} s (limit {LIMITS['more']:g}), from the cache at most "
        f"{max(cost.cached.values()):.3f} s (limit {LIMITS['cached']:g}).",
    ])  # fmt: skip


def _uncertainty(session: Session) -> list[str]:
    spreads = sorted(p.time.relative for p in session.points if p.completed and len(p.seconds) > 2)
    wide = spreads[int(0.9 * len(spreads))]
    lines = [
        f"{session.repeats} repeats of every combination in turns, one session of {session.seconds:.0f} s; medians of turns, a turn "
        "being the best of 3 runs in a row (1 for tensortrax). Half the interquartile range is "
        f"{100 * statistics.median(spreads):.0f} % of the median run time in the middle, {100 * wide:.0f} % for one combination in "
        "ten. Errors and counts are exact repeats."
    ]
    if wide > BUSY:
        lines.append(
            f"The machine was busy ({100 * wide:.0f} % above): repeat on an idle one before quoting run times; the counts of calls "
            "and instructions hold as they are."
        )
    return lines


def _points(session: Session) -> Table:
    rows = [
        [p.problem, p.scheme, p.control, p.increments, p.iterations, p.umat_calls, 1e3 * p.time.median, 1e3 * p.time.half,
         ", ".join(f"{name} {value:.1e}" for name, value in p.errors.items()) or p.message]
        for p in session.points
    ]  # fmt: skip
    spread = Column("+-", ".2f", "ms")
    return Table(["problem", "scheme", "control", INCREMENTS, Column("iterations", "d"), CALLS, MS, spread, "errors"], rows)
