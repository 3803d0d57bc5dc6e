"""What must hold, on the reduced matrix: both materials, all temperatures, fewer cases and random states."""

import pytest

from plyflow.evidence.stability.cells import WHOLE, Verdict
from plyflow.evidence.stability.matrix import CLAIMS, TABLE, Matrix
from plyflow.evidence.stability.subject import Subject


@pytest.mark.parametrize("statement", CLAIMS)
def test_claim_holds(matrix: Matrix, statement: str) -> None:
    finding = next(found for found in matrix.findings if found.statement == statement)
    assert finding.worst is not None
    assert finding.holds, finding.worst.outcome.reason


def test_no_cell_fails(matrix: Matrix) -> None:
    assert [(cell.check.name, cell.column, cell.outcome.reason) for cell in matrix.failing] == []


def test_nothing_happens_that_must_not(matrix: Matrix) -> None:
    """No NaN, no Inf, no stress from the wrong side, no silent refusal, nothing uncaught; and it looked at a lot."""
    assert matrix.ledger.lines() == []
    assert matrix.ledger.calls > 10_000
    assert matrix.ledger.increments > 100_000


def test_every_refused_cell_has_its_message(matrix: Matrix) -> None:
    refused = [cell for cell in matrix.cells if cell.outcome.verdict is Verdict.REFUSED]
    assert len(refused) > 50
    assert all(len(cell.outcome.reason) > 20 for cell in refused)


def test_every_check_is_made_on_both_materials_and_all_temperatures(matrix: Matrix, subject: Subject) -> None:
    columns = {column.label for column in subject.columns}
    assert len(columns) == 14
    for check in {cell.check for cell in matrix.cells}:
        own = {cell.column for cell in matrix.cells if cell.check == check}
        assert own in ({WHOLE}, columns) or "refined 1 to 32 times" in check.name


def test_every_group_and_every_claim_of_the_table_is_there(matrix: Matrix) -> None:
    assert {cell.check.group for cell in matrix.cells} == {
        TABLE["account"]["title"],
        *(family["title"] for family in TABLE["family"]),
    }
    assert {cell.check.claim for cell in matrix.cells} - {""} == set(CLAIMS)
