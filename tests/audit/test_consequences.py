"""Consequences in numbers: against the integrated law, and against cases with a known answer."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from plyflow.audit.consequence import Consequences
from plyflow.audit.creep import FloatArray, compact, reference_case
from plyflow.audit.report import Audit
from plyflow.law import LoadProgramme, Stage, integrate
from umataudit import Effect, Variant, Verdict
from umataudit.printed.letters import sym


@pytest.fixture(scope="module")
def consequences() -> Consequences:
    return Consequences()


def test_the_separable_integral_gives_the_integrated_law() -> None:
    reference = reference_case()
    outcome = compact(reference)
    history = integrate(reference.law, reference.load, [reference.load.end])
    assert outcome.strain == pytest.approx(float(history.eps[-1]), abs=1e-7)
    assert outcome.lock_time == pytest.approx(history.lock_time, rel=1e-3)


def test_twice_the_resistance_is_half_the_load() -> None:
    reference = reference_case()
    halved = LoadProgramme(reference.load.times, tuple(p / 2 for p in reference.load.pressures))

    def twice(eps: FloatArray, stage: Stage) -> FloatArray:
        return np.full_like(eps, math.log(2.0))

    assert compact(reference, twice).strain == pytest.approx(compact(replace(reference, load=halved)).strain, abs=1e-9)


def test_a_factor_of_one_changes_nothing(consequences: Consequences) -> None:
    said = consequences.text(Effect((Variant("nothing", {"squeeze": sp.S.One, "bleed": sp.S.One}),)))
    assert "unchanged" in said


def test_stress_ratio_and_thickness_of_a_known_factor(consequences: Consequences) -> None:
    eps = sym("eps")[0]
    result = consequences.variant(Variant("exp(2 eps)", {"bleed": sp.exp(2 * eps)}))
    assert 10 ** result.log_ratios[Stage.BLEED] == pytest.approx(math.exp(-0.4))
    assert result.outcome.thickness < consequences.derived.thickness


def test_a_singular_form_stops_at_its_own_limit(consequences: Consequences) -> None:
    limit = sp.Rational(8, 10)
    eps = sym("eps")[0]
    wall = (sp.Rational(1, 100) / (sp.exp(eps) - limit)) ** 2
    result = consequences.variant(Variant("a wall at 0.8", {"bleed": wall}, limit=limit))
    assert 0.8 < result.outcome.thickness < 0.83


def test_each_misprint_has_a_consequence(audited: Audit) -> None:
    for row in audited.rows:
        if row.verdict is Verdict.MISPRINT:
            assert any(
                word in row.consequence
                for word in ("stress x", "h/h0", "no solution", "none on a computed result", ": ")
            )
            assert row.consequence


def test_eq_13_halves_the_stress_and_the_thickness_is_decided_after_locking(audited: Audit) -> None:
    text = next(row.consequence for row in audited.rows if row.id == "13")
    a, half = -0.866, reference_case().law.eps_lock / 2
    trace = math.exp(2 * half) + math.exp(-2 * half)
    expected = math.exp(6 * half) * ((trace**2 - 2) / (trace**2 + 2)) ** ((a + 2) / 2)
    assert f"stress x {expected:.4g} in squeezing" in text
    assert "unchanged" in text


def test_the_printed_tangent_makes_newton_repeat_its_error(audited: Audit) -> None:
    text = next(row.consequence for row in audited.rows if row.id == "16")
    assert "viscous tangent as printed over derived: 0.5" in text
    assert "no solution" in text
