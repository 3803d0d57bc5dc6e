"""One numeric factor of the emitted source is changed: the comparison with the oracle must fail."""

import re
from typing import Any

import numpy as np
import pytest

from oracle import State, energies, properties_of, random_states
from oracle.compare import Errors, statev_at_start, umat_errors
from plyflow.umat.compile import compile_umat
from plyflow.umat.library import UmatLibrary

STRESS_TOLERANCE = 1.0e-12
DDSDDE_TOLERANCE = 1.0e-9
SHEAR = np.array([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
LITERAL = re.compile(r"(?<![\w.])(\d+\.\d+)d0\b")
STATES = {name: random_states(40, 16, locked) for name, locked in {"squeeze": False, "bleed": True}.items()}


def procedure(source: str, block: str) -> tuple[int, int]:
    """Where the statements of a procedure lie in the source, from its declarations on."""
    found = re.search(rf"SUBROUTINE \w+_{block}\(.*?END SUBROUTINE \w+_{block}\b", source, re.DOTALL)
    assert found is not None, f"the emitted source has no procedure {block}"
    return found.span()


def literals(source: str, block: str) -> list[tuple[int, int]]:
    """Places of the real constants of a procedure that are not zero."""
    start, end = procedure(source, block)
    return [m.span(1) for m in LITERAL.finditer(source, start, end) if float(m.group(1)) != 0.0]


def planted(source: str, place: tuple[int, int]) -> str:
    """Copy the source with the last digit of one constant raised by one: its columns stay where they are."""
    last = place[1] - 1
    digit = str((int(source[last]) + 1) % 10)
    return source[:last] + digit + source[place[1] :]


def worst(library: UmatLibrary, regime: str) -> Errors:
    """Largest errors over the states of a regime."""
    errors = umat_errors(library, STATES[regime])
    return Errors(max(e.stress for e in errors), max(e.ddsdde for e in errors))


def worst_of_planted(source: str, block: str, regime: str) -> list[Errors]:
    """Errors with the first, and with the last, constant of a block changed."""
    places = literals(source, block)
    assert places, f"procedure {block} has no constant to change"
    return [worst(UmatLibrary(compile_umat(planted(source, p))), regime) for p in (places[0], places[-1])]


@pytest.mark.parametrize("regime", STATES)
def test_the_source_as_emitted_passes(umat: UmatLibrary, regime: str) -> None:
    errors = worst(umat, regime)
    assert errors.stress <= STRESS_TOLERANCE and errors.ddsdde <= DDSDDE_TOLERANCE


@pytest.mark.parametrize(
    ("block", "regime"),
    [("moduli", "bleed"), ("kinematics", "squeeze"), ("squeeze", "squeeze"), ("bleed", "bleed"), ("stress", "bleed")],
)
def test_an_error_in_a_constant_of_the_stress_is_seen(emitted: Any, block: str, regime: str) -> None:
    for errors in worst_of_planted(emitted.source, block, regime):
        assert errors.stress > STRESS_TOLERANCE or errors.ddsdde > DDSDDE_TOLERANCE


@pytest.mark.parametrize("block", ["gradient", "tangent"])
def test_an_error_in_a_constant_of_the_tangent_is_seen_there_and_only_there(emitted: Any, block: str) -> None:
    for errors in worst_of_planted(emitted.source, block, "squeeze"):
        assert errors.stress <= STRESS_TOLERANCE
        assert errors.ddsdde > DDSDDE_TOLERANCE


@pytest.mark.parametrize("regime", STATES)
def test_an_error_in_the_penalty_is_seen_before_the_lock_only(emitted: Any, regime: str) -> None:
    start, _ = procedure(emitted.source, "point")
    place = emitted.source.index("kappa = props(15)", start)
    wrong = emitted.source[:place] + "kappa = props(14)" + emitted.source[place + len("kappa = props(15)") :]
    errors = worst(UmatLibrary(compile_umat(wrong)), regime)
    assert (errors.stress > STRESS_TOLERANCE) is (regime == "squeeze")
    assert (errors.ddsdde > DDSDDE_TOLERANCE) is (regime == "squeeze")


def test_an_error_in_the_elastic_part_is_seen(emitted: Any) -> None:
    start, end = procedure(emitted.source, "elastic")
    coefficient = re.compile(r"c_fibre = .*?(\d\.\d+)d0", re.DOTALL).search(emitted.source, start, end)
    assert coefficient is not None
    errors = worst(UmatLibrary(compile_umat(planted(emitted.source, coefficient.span(1)))), "squeeze")
    assert errors.stress > STRESS_TOLERANCE


def stored_energy_error(library: UmatLibrary, state: State) -> float:
    """Error of SSE relative to the oracle."""
    arguments = (state.start, state.end, state.time_increment, state.props)
    found = library.call(*arguments, statev_at_start(state.locked)).sse
    wanted = energies(*arguments, state.locked)
    return abs(found / float(wanted.elastic + wanted.penalty) - 1.0)


def test_an_error_in_the_energy_is_seen_by_sse(emitted: Any, umat: UmatLibrary) -> None:
    last = literals(emitted.source, "elastic")[-1]
    wrong = UmatLibrary(compile_umat(planted(emitted.source, last)))
    assert worst(wrong, "squeeze").stress <= STRESS_TOLERANCE
    assert max(stored_energy_error(umat, state) for state in STATES["squeeze"]) < 1e-10
    assert max(stored_energy_error(wrong, state) for state in STATES["squeeze"]) > 1e-10


def test_an_error_in_the_start_strain_moves_the_landing_on_the_lock(emitted: Any, umat: UmatLibrary) -> None:
    wrong = UmatLibrary(compile_umat(planted(emitted.source, literals(emitted.source, "start")[0])))
    start, end = (np.diag([1.05, np.exp(-eps), np.exp(eps)]) @ SHEAR for eps in (-0.02, -0.08))
    fractions = [library.call(start, end, 1.0, properties_of(), np.zeros(8)).pnewdt for library in (umat, wrong)]
    assert 0.0 < fractions[0] < 1.0
    assert abs(fractions[1] / fractions[0] - 1.0) > 1e-3
