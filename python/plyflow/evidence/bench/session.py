"""Everything that one session of the bench measures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from plyflow.case.case import assumption_lines
from plyflow.evidence.bench.all_cases import CaseCounts
from plyflow.evidence.bench.extras import Rounding
from plyflow.evidence.bench.generation import GenerationCosts
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.problems import Problem
from plyflow.evidence.bench.schemes import DEFAULT, PAPER, PAPER_REAL, PLAIN, Scheme
from plyflow.evidence.bench.verdict import comparisons, counted, statement

NOT_SHOWN = (
    "a finite-element model: this is one material point with its driver, whose share of a call is given above",
    "Abaqus, its Newton and its increments; other compilers and flags; other machines",
    "a programme run wholly in quadruple precision: it checks stress and tangent of every increment of the double one",
    "memory and cache effects of many points, except in the batch rate",
    "run times below the spread: differences of a few percent between neighbours are not resolved",
)


@dataclass(frozen=True)
class Session:
    """What was measured; `seconds` is the length of the whole session, `values` are PROPS by name of each problem."""

    quick: bool
    repeats: int
    problems: list[Problem]
    schemes: list[Scheme]
    left_out: dict[str, str]
    points: list[Point]
    recommended: str
    cases: dict[str, CaseCounts]
    rounding: Rounding
    distances: dict[str, float]
    rates: dict[int, list[float]]
    batch_points: int
    instructions: dict[str, float | None]
    generation: GenerationCosts
    machine: dict[str, Any]
    values: dict[str, dict[str, float]]
    seconds: float
    figures: dict[str, str] = field(default_factory=dict)

    @property
    def loads(self) -> list[str]:
        """Names of the problems under a load: those that the recommendation rests on."""
        return [problem.name for problem in self.problems if problem.kind == "load"]

    def assumptions(self, problem: Problem) -> list[str]:
        """What the numbers of a problem rest on."""
        return assumption_lines(problem.case, self.values[problem.name])

    def verdict(self) -> list[str]:
        """Recommendation and ratios, one line each."""
        schemes = dict.fromkeys((self.recommended, DEFAULT))
        told = [statement(self.points, self.loads, scheme, base) for scheme in schemes for base in (PAPER, PAPER_REAL)]
        lines = counted(self.points, self.loads, DEFAULT, PLAIN)
        cases = [f"{name}: {found.line()}" for name, found in self.cases.items()]
        return [f"recommended: scene '{self.recommended}'", *told, *lines, *cases]

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data for JSON."""
        return {
            "recommended": self.recommended,
            "verdict": self.verdict(),
            "comparisons": [one.as_dict() for one in comparisons(self.points, self.loads, self.recommended)],
            "machine": self.machine,
            "quick": self.quick,
            "repeats": self.repeats,
            "seconds": self.seconds,
            "problems": {p.name: {"label": p.label, "kind": p.kind, "inputs": self.values[p.name],
                                  "assumptions": self.assumptions(p)} for p in self.problems},
            "schemes": {s.name: {"kind": s.kind, **s.traits} for s in self.schemes},
            "left_out": self.left_out,
            "points": [point.as_dict() for point in self.points],
            "cases": {name: vars(found) for name, found in self.cases.items()},
            "rounding": vars(self.rounding),
            "distance_of_the_model": self.distances,
            "batch": {"points": self.batch_points, "calls_per_second": {str(n): r for n, r in self.rates.items()}},
            "instructions_per_call": self.instructions,
            "generation": vars(self.generation),
            "not_shown": list(NOT_SHOWN),
        }  # fmt: skip
