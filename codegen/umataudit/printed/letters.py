"""The paper's letters: what each stands for, its unit, and the SymPy symbol behind it.

A letter that the model has too uses the model's symbol (`notation.TABLE`), so that a printed relation, a derived one and
the emitted one are expressions in the same symbols. Tensor letters become 3x3 matrices of symbols.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from typing import Any

import sympy as sp

from umatgen.notation import TABLE


@dataclass(frozen=True)
class Letter:
    """One letter of the paper.

    Parameters
    ----------
    name : how formulas spell it; also its plain-text form.
    math : LaTeX.
    meaning : one line.
    unit : unit as an expression in MPa, mm and s ("1" when there is none); with `logarithm` the unit of exp(letter).
    sign : "positive", "negative" or "real".
    quantity : name in `notation.TABLE` when the model has it.
    shape : "" for a scalar, "general" or "symmetric" for a 3x3 tensor, "fourth" for one of fourth order.
    logarithm : whether the letter is the logarithm of something with a unit.
    range : where random admissible points may lie.
    """

    name: str
    math: str
    meaning: str
    unit: str = "1"
    sign: str = "positive"
    quantity: str = ""
    shape: str = ""
    logarithm: bool = False
    range: tuple[float, float] | None = None

    @cached_property
    def symbol(self) -> sp.Symbol:
        """SymPy symbol of a scalar letter."""
        return TABLE.symbol(self.quantity) if self.quantity else sp.Symbol(self.name, **{self.sign: True})

    @cached_property
    def value(self) -> Any:
        """Symbol of a scalar; 3x3 matrix, or array of shape (3, 3, 3, 3) with both minor symmetries, of symbols."""
        if not self.shape:
            return self.symbol
        if self.shape == "fourth":
            return sp.Array([self._component(n // 27, n // 9 % 3, n // 3 % 3, n % 3) for n in range(81)], (3, 3, 3, 3))
        return sp.Matrix(3, 3, self._component)

    def _component(self, *index: int) -> sp.Symbol:
        """Symbol of one component (indices from 0)."""
        pairs = [index[n : n + 2] for n in range(0, len(index), 2)]
        ordered = pairs if self.shape == "general" else map(sorted, pairs)
        return sp.Symbol(f"{self.name}_{''.join(str(n + 1) for pair in ordered for n in pair)}", real=True)


def _letter(name: str, entry: dict[str, Any]) -> Letter:
    known = TABLE[entry["quantity"]] if "quantity" in entry else None
    return Letter(name, **({"math": known.math, "meaning": known.meaning} if known else {}) | entry)


_FILE = resources.files("umataudit") / "printed" / "letters.toml"
LETTERS = {name: _letter(name, entry) for name, entry in tomllib.loads(_FILE.read_text(encoding="utf-8")).items()}
BY_SYMBOL = {letter.symbol.name: letter for letter in LETTERS.values() if not letter.shape}


def sym(names: str) -> tuple[sp.Symbol, ...]:
    """Symbols of scalar letters, names separated by blanks."""
    return tuple(LETTERS[name].symbol for name in names.split())


def tensor(name: str) -> sp.Matrix:
    """The 3x3 matrix of a tensor letter."""
    return LETTERS[name].value
