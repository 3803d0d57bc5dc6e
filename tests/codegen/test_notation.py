"""The symbol table refuses what Fortran cannot tell apart."""

from __future__ import annotations

import pytest

from umatgen.notation import TABLE, NotationError, Quantity, SymbolTable


def test_names_equal_when_lower_cased_are_refused() -> None:
    with pytest.raises(NotationError, match="'kappa' and 'KAPPA' are one name in Fortran"):
        SymbolTable([Quantity("kappa", "", "", ""), Quantity("KAPPA", "", "", "")])


@pytest.mark.parametrize("name", ["2fast", "with space", "x" * 32, "\u03b7"])
def test_names_that_are_not_fortran_are_refused(name: str) -> None:
    with pytest.raises(NotationError, match="is no Fortran name"):
        SymbolTable([Quantity(name, "", "", "")])


def test_every_quantity_says_what_it_is_and_in_which_unit() -> None:
    assert all(q.meaning and q.unit and q.math for q in TABLE)
