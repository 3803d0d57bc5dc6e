"""One numeric factor of the emitted source is changed: the comparison with the oracle must fail."""

import re
from typing import Any

import pytest

from oracle import State, energies
from oracle.compare import Errors, statev_at_start
from plyflow.umat.library import UmatLibrary
from umat.planted import DDSDDE_TOLERANCE, REGIMES, STRESS_TOLERANCE, compiled, drawn, worst

LITERAL = re.compile(r"(?<![\w.])(\d+\.\d+)d0\b")
STATES = {regime: drawn(regime, 40, 16) for regime in REGIMES}


def procedure(source: str, block: str) -> tuple[int, int]:
    """Where the statements of a procedure lie in the source, from its declarations on."""
    found = re.search(rf"SUBROUTINE \w+_{block}\(.*?END SUBROUTINE \w+_{block}\b", source, re.DOTALL)
    assert found is not None, f"the emitted source has no procedure {block}"
    return found.span()


def literals(source: str, block: str) -> list[tuple[int, int]]:
    """Places of the real constants of a procedure that are not zero."""
    start, end = procedure(source, block)
    return [m.span(1) for m in LITERAL.finditer(source, start, end) if float(m.group(1)) != 0.0]


def planted(source: str, place: tuple[int, int]) -> UmatLibrary:
    """Compile with the last digit of one constant raised by one: the columns stay where they are."""
    last = place[1] - 1
    return compiled(source[:last] + str((int(source[last]) + 1) % 10) + source[place[1] :])


def errors_of_planted(source: str, block: str, regime: str) -> list[Errors]:
    """Errors with the first, and with the last, constant of a block changed."""
    places = literals(source, block)
    assert places, f"procedure {block} has no constant to change"
    return [worst(planted(source, place), STATES[regime]) for place in (places[0], places[-1])]


def seen(errors: Errors) -> tuple[bool, bool]:
    """Whether stress and tangent are outside their tolerances."""
    return errors.stress > STRESS_TOLERANCE, errors.ddsdde > DDSDDE_TOLERANCE


@pytest.mark.parametrize("regime", REGIMES)
def test_the_source_as_emitted_passes(umat: UmatLibrary, regime: str) -> None:
    assert seen(worst(umat, STATES[regime])) == (False, False)


@pytest.mark.parametrize(
    ("block", "regime"),
    [
        ("moduli", "bleed"), ("kinematics", "squeeze"), ("kinematics", "across"), ("squeeze", "squeeze"),
        ("bleed", "bleed"), ("bleed", "across"), ("stress", "bleed"),
    ],
)  # fmt: skip
def test_an_error_in_a_constant_of_the_stress_is_seen(emitted: Any, block: str, regime: str) -> None:
    for errors in errors_of_planted(emitted.source, block, regime):
        assert any(seen(errors))


@pytest.mark.parametrize(("block", "regime"), [("gradient", "squeeze"), ("tangent", "squeeze"), ("tangent", "across")])
def test_an_error_in_a_constant_of_the_tangent_is_seen_there_and_only_there(
    emitted: Any, block: str, regime: str
) -> None:
    for errors in errors_of_planted(emitted.source, block, regime):
        assert seen(errors) == (False, True)


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("kappa = props(15)", "kappa = props(14)", {"squeeze"}),
        ("sqrt(\n     &      x_start)", "sqrt(\n     &      x_lock )", {"across"}),
        ("IF (x_end <= x_lock) THEN", "IF (x_start <= x_lock) THEN", {"across"}),
    ],
    ids=["penalty", "width at the lock", "stage by the start"],
)
@pytest.mark.parametrize("regime", REGIMES)
def test_an_error_of_one_stage_is_seen_there_only(
    emitted: Any, old: str, new: str, where: set[str], regime: str
) -> None:
    assert seen(worst(compiled(emitted.source, (old, new)), STATES[regime])) == (regime in where,) * 2


def test_an_error_in_the_elastic_part_is_seen(emitted: Any) -> None:
    start, end = procedure(emitted.source, "elastic")
    coefficient = re.compile(r"c_fibre = .*?(\d\.\d+)d0", re.DOTALL).search(emitted.source, start, end)
    assert coefficient is not None
    assert seen(worst(planted(emitted.source, coefficient.span(1)), STATES["squeeze"]))[0]


def stored_energy_error(library: UmatLibrary, state: State) -> float:
    """Error of SSE relative to the oracle."""
    arguments = (state.start, state.end, state.time_increment, state.props)
    found = library.call(*arguments, statev_at_start(state.locked)).sse
    wanted = energies(*arguments, state.locked)
    return abs(found / float(wanted.elastic + wanted.penalty) - 1.0)


def test_an_error_in_the_energy_is_seen_by_sse(emitted: Any, umat: UmatLibrary) -> None:
    wrong = planted(emitted.source, literals(emitted.source, "elastic")[-1])
    assert worst(wrong, STATES["squeeze"]).stress <= STRESS_TOLERANCE
    assert max(stored_energy_error(umat, state) for state in STATES["squeeze"]) < 1e-10
    assert max(stored_energy_error(wrong, state) for state in STATES["squeeze"]) > 1e-10
