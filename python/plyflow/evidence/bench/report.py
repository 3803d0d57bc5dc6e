"""The report of a bench session as Markdown and JSON."""

from __future__ import annotations

import json
import statistics
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from plyflow.case.case import assumption_lines
from plyflow.evidence.bench.accuracy import MARGIN, TARGET, cost_at, median_seconds, pick, umat_calls
from plyflow.evidence.bench.extras import middle
from plyflow.evidence.bench.generation import LIMITS
from plyflow.evidence.bench.problems import QUANTITIES, SPEED_DURATION, SPEED_THICKNESS
from plyflow.evidence.bench.schemes import DEFAULT, PAPER, PAPER_REAL
from plyflow.evidence.bench.verdict import comparisons, statement

if TYPE_CHECKING:
    from plyflow.evidence.bench.run import Session

BUSY = 0.2  # spread of one combination in ten from which the machine counts as busy
NOT_SHOWN = (
    "a finite-element model: this is one material point with its driver, whose share of a call is given below",
    "Abaqus, its Newton and its increments; other compilers and flags; other machines",
    "a programme run wholly in quadruple precision: it checks stress and tangent of every increment of the double one",
    "memory and cache effects of many points, except in the batch rate",
    "run times below the spread: differences of a few percent between neighbours are not resolved",
)


def verdict_lines(session: Session) -> list[str]:
    """Recommendation and ratios, one line each."""
    names = [problem.name for problem in session.problems if problem.kind == "load"]
    lines = [f"recommended: scene '{session.recommended}'"]
    for scheme in dict.fromkeys((session.recommended, DEFAULT)):
        lines += [statement(session.points, names, scheme, base) for base in (PAPER, PAPER_REAL)]
    return lines


def to_markdown(session: Session) -> str:
    """The whole report."""
    parts = [
        "# Work-precision\n",
        *(f"- {line}\n" for line in verdict_lines(session)),
        f"\nThe recommendation is the scene with open constants that reaches {TARGET:g} in final thickness in the least run "
        f"time (geometric mean over the programmes) and keeps the width to {TARGET:g}; the default one stays unless beaten "
        f"by more than {100 * (1 - MARGIN):.0f} %. The paper's scheme is bdf1 with the tangent of Eq. 16; '{PAPER}' has the "
        f"invariants of Eqs. 13-14 in I1 and I3 (the scene 'printed' has them too, with a tangent of its own), the scene "
        f"'{PAPER_REAL}' the same ones where they are always real.\n",
        _target_section(session), _figure_section(session), _peer_section(session), _exactness_section(session),
        _cost_section(session), _uncertainty_section(session), _participants(session), _inputs(session), _points(session),
    ]  # fmt: skip
    return "\n".join(part.rstrip("\n") for part in parts) + "\n"


def to_json(session: Session) -> str:
    """Everything as one JSON object."""
    names = [problem.name for problem in session.problems if problem.kind == "load"]
    data: dict[str, Any] = {
        "recommended": session.recommended,
        "verdict": verdict_lines(session),
        "comparisons": [_plain(one) for one in comparisons(session.points, names, session.recommended)],
        "machine": session.machine,
        "quick": session.quick,
        "repeats": session.repeats,
        "seconds": session.seconds,
        "problems": {p.name: {"label": p.label, "kind": p.kind, "inputs": session.values[p.name],
                              "assumptions": assumption_lines(p.case, session.values[p.name])} for p in session.problems},
        "schemes": {s.name: {"kind": s.kind, **s.traits} for s in session.schemes},
        "left_out": session.left_out,
        "points": [point.as_dict() for point in session.points],
        "rounding": vars(session.rounding),
        "distance_of_the_model": session.distances,
        "batch": {"points": session.batch_points, "calls_per_second": {str(n): r for n, r in session.rates.items()}},
        "instructions_per_call": session.instructions,
        "generation": vars(session.generation),
        "not_shown": list(NOT_SHOWN),
    }  # fmt: skip
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def _plain(one: Any) -> dict[str, Any]:
    return {**vars(one), "time": None if one.time is None else vars(one.time)}


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(row) + " |" for row in ([*head], ["---"] * len(head), *rows)]
    return "\n" + "\n".join(lines) + "\n"


def _target_section(session: Session) -> str:
    loads = [problem.name for problem in session.problems if problem.kind == "load"]
    rows = []
    for scheme in session.schemes:
        row = [scheme.name, *scheme.traits.values()]
        for problem in loads:
            mine, base = (pick(session.points, problem, name) for name in (scheme.name, DEFAULT))
            time, calls = (cost_at(mine, "thickness", TARGET, cost) for cost in (median_seconds, umat_calls))
            reference = cost_at(base, "thickness", TARGET, median_seconds)
            if not mine or time is None or calls is None or reference is None:
                row.append("not run" if not mine else "not reached")
            else:
                row.append(f"{1e3 * time:.2f} ms, {time / reference:.2f} x, {calls:.0f} calls")
        rows.append(row)
    head = ("scheme", "tangent", "integrator", "Newton", *loads)
    return (
        f"\n## What {TARGET:g} in final thickness costs\n\nRun time of the whole programme, its ratio to the default scene, "
        "calls of the UMAT; best step control, read between the points in logarithms.\n" + _table(head, rows)
    )


def _figure_section(session: Session) -> str:
    text = "\n## Error against run time and increments\n\nSolid: increments grown by a factor or equal; dotted: strain tolerance.\n"
    for problem in session.problems:
        for quantity in problem.quantities:
            text += f"\n![{problem.label}: {QUANTITIES[quantity]}]({problem.name}-{quantity}.svg)\n"
    return text


def _peer_section(session: Session) -> str:
    rows = []
    for point in session.points:
        scheme = next(s for s in session.schemes if s.name == point.scheme)
        twin = [p for p in pick(session.points, point.problem, DEFAULT) if p.control == point.control]
        if scheme.kind == "peer" and twin and point.control in ("growth 0.3", "growth 1", "equal 30"):
            took = point.message[:60] if point.message else f"{1e3 * point.median:.2f} ms"
            times = "" if point.message else f"{point.median / twin[0].median:.1f}"
            per_call = "" if point.message else f"{1e6 * point.median / point.umat_calls:.2f}"
            rows.append([point.problem, point.control, point.scheme, took, times, per_call, str(point.umat_calls),
                         str(twin[0].umat_calls)])  # fmt: skip
    head = ("problem", "control", "peer", "run time", "x default", "us a call, driver included", "calls", "calls of default")
    return (
        "\n## Peers\n\nThe same material behind the same driver: `perturbed` takes DDSDDE from forward differences of 1e-8, "
        "`four_index` pushes a fourth-order tensor forward index by index, `tensortrax` differentiates the potentials "
        "written in NumPy.\n" + _table(head, rows)
    )


def _exactness_section(session: Session) -> str:
    found = session.rounding
    lines = [
        "\n## What the errors rest on\n",
        "- Reference: the one-dimensional law at a relative tolerance of 1e-13.",
        f"- Rounding: along {found.increments} increments of the first problem the double-precision stress is off the "
        f"quadruple-precision one by {found.stress[0]:.1e} (median), {found.stress[1]:.1e} (worst), DDSDDE by "
        f"{found.ddsdde[0]:.1e} and {found.ddsdde[1]:.1e}, relative to the largest entry.",
    ]
    lines += [
        f"- {name}: at vanishing increments the final thickness stays {distance:.1e} (relative, extrapolated) from the law: "
        "elasticity and penalty, which the law has not."
        for name, distance in session.distances.items()
    ]
    lines.append(
        "- Width: it is set where the lock is met, so the landing tolerance (1e-5 of strain) bounds its error and the "
        "increments hardly matter."
    )
    lines.append(
        f"- Plate speed: h/h0 falls from 1 to {SPEED_THICKNESS:g} in {SPEED_DURATION:g} s; the law's stress has no elastic "
        "part, which is the floor of that error. The blend scene, which spreads the jump at the lock on purpose, has no "
        "entry there."
    )
    return "\n".join(lines) + "\n"


def _cost_section(session: Session) -> str:
    text = "\n## Costs beside the runs\n"
    rows = []
    base = middle(session.rates[1])[0]
    for threads, rates in session.rates.items():
        rate, spread = middle(rates)
        best = max(rates)
        rows.append([str(threads), f"{rate / 1e6:.2f}", f"{spread / 1e6:.2f}", f"{rate / base:.2f}", f"{best / 1e6:.2f}",
                     f"{best / max(session.rates[1]):.2f}"])  # fmt: skip
    text += f"\nBatch entry, default scene, {session.batch_points} points a batch, through Python:\n"
    text += _table(("threads", "million calls/s", "spread", "x 1 thread", "best", "x 1 thread, best"), rows)
    text += _share(session, max(session.rates[1]))
    counts = [[name, "no valgrind" if n is None else f"{n:.0f}"] for name, n in session.instructions.items()]
    text += "\nInstructions a call, both stages averaged, empty loop subtracted (callgrind, gfortran -O2):\n"
    text += _table(("scheme", "instructions"), counts)
    cost = session.generation
    first = next(iter(cost.cold))
    others = max(seconds for name, seconds in cost.cold.items() if name != first)
    text += (
        f"\nGeneration in a fresh process, processor time ({cost.start:.1f} s to start Python's modules): '{first}' "
        f"{cost.cold[first]:.2f} s cold (limit {LIMITS['cold']:g}), any other scene at most {others:.2f} s (limit "
        f"{LIMITS['more']:g}), from the cache at most {max(cost.cached.values()):.3f} s (limit {LIMITS['cached']:g}).\n"
    )
    return text


def _share(session: Session, rate: float) -> str:
    """What of a call in the runs is the UMAT's."""
    mine = [p for p in session.points if p.scheme == DEFAULT and p.completed]
    per_call = statistics.median(min(p.seconds) / p.umat_calls for p in mine)
    return (
        f"\nA call of the default scene takes {1e6 / rate:.2f} us in the batch and {1e6 * per_call:.2f} us in the runs above (best), "
        "driver and solution included: the driver's share dilutes what a cheaper UMAT gains in run time.\n"
    )


def _uncertainty_section(session: Session) -> str:
    spreads = sorted(p.spread for p in session.points if p.completed and len(p.seconds) > 2)
    wide = spreads[int(0.9 * len(spreads))]
    lines = [
        "\n## Uncertainty, machine, limits\n",
        f"- {session.repeats} repeats of every combination in turns, one session of {session.seconds:.0f} s; medians of turns, "
        "a turn being the best of 3 runs in a row (1 for tensortrax). Half "
        f"the interquartile range is {100 * statistics.median(spreads):.0f} % of the median run time in the middle, "
        f"{100 * wide:.0f} % for one combination in ten. Errors and counts are exact repeats.",
        "- " + "; ".join(f"{name}: {value}" for name, value in session.machine.items()),
        *([f"- The machine was busy ({100 * wide:.0f} % above): repeat on an idle one before quoting run times; the counts of "
           "calls and instructions hold as they are."] if wide > BUSY else []),
        "- Not shown: " + "; ".join(NOT_SHOWN) + ".",
    ]
    return "\n".join(lines) + "\n"


def _participants(session: Session) -> str:
    rows = [[name, why] for name, why in session.left_out.items()]
    return "\n## Scenes that take no part\n" + _table(("scene", "why"), rows)


def _inputs(session: Session) -> str:
    text = "\n## Inputs and assumptions\n"
    for problem in session.problems:
        values = session.values[problem.name]
        text += f"\n**{problem.name}**: {problem.label}. " + "; ".join(f"{n} = {v:g}" for n, v in values.items()) + "\n\n"
        text += "".join(f"- {line}\n" for line in assumption_lines(problem.case, values))
    return text


def _points(session: Session) -> str:
    rows = []
    for point in session.points:
        errors = ", ".join(f"{name} {value:.1e}" for name, value in point.errors.items()) or point.message[:80]
        time = f"{1e3 * point.median:.2f} +- {1e3 * point.spread * point.median:.2f}"
        rows.append([point.problem, point.scheme, point.control, str(point.increments), str(point.iterations),
                     str(point.umat_calls), time, errors])  # fmt: skip
    head = ("problem", "scheme", "control", "increments", "iterations", "calls", "ms", "errors")
    return "\n## All runs\n" + _table(head, rows)
