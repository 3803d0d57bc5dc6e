"""Named definitions and the chain rule through them.

Differentiating through names instead of substituting them keeps the derivative as short as the model itself:
d g/d A22 comes out in terms of `gap`, `stretch`, `cos2`, which the emitted code has already computed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import sympy as sp


@dataclass(frozen=True)
class Definition:
    """A named scalar.

    Parameters
    ----------
    symbol : its name.
    expr : what it is, in terms of earlier names.
    equation : where it comes from ("13", "sec. 4.3", ...).
    stable : form to evaluate when `expr` cancels; equal to `expr` (tested symbolically), None when it is `expr` itself.
    partials : partial derivatives to use in place of differentiating `expr` (for instance bounded names for d/r and s/r);
        they too are tested against the derivative of `expr`.
    """

    symbol: sp.Symbol
    expr: sp.Expr
    equation: str
    stable: sp.Expr | None = None
    partials: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def partial(self, wrt: sp.Symbol) -> sp.Expr:
        """Partial derivative of the definition with respect to one of the names it uses."""
        if self.partials:
            return self.partials.get(wrt, sp.S.Zero)
        return sp.diff(self.expr, wrt)

    @property
    def arguments(self) -> tuple[sp.Symbol, ...]:
        """The names the definition depends on, sorted."""
        names = self.partials.keys() if self.partials else self.expr.free_symbols
        return tuple(sorted((s for s in names if isinstance(s, sp.Symbol)), key=str))


class Chain:
    """An ordered set of definitions with the chain rule.

    Raises
    ------
    ValueError
        When a name is defined twice.
    """

    def __init__(self, definitions: Iterable[Definition]) -> None:
        self._by_symbol: dict[sp.Symbol, Definition] = {}
        for definition in definitions:
            if definition.symbol in self._by_symbol:
                raise ValueError(f"'{definition.symbol}' is defined twice in the model")
            self._by_symbol[definition.symbol] = definition
        self._cache: dict[tuple[sp.Symbol, sp.Symbol], sp.Expr] = {}

    def __iter__(self) -> Iterator[Definition]:
        return iter(self._by_symbol.values())

    def __contains__(self, symbol: object) -> bool:
        return symbol in self._by_symbol

    def __getitem__(self, symbol: sp.Symbol) -> Definition:
        return self._by_symbol[symbol]

    def derivative(self, expr: sp.Expr, wrt: sp.Symbol) -> sp.Expr:
        """Total derivative of `expr` with respect to `wrt`, through all definitions, names left unexpanded."""
        total = sp.S.Zero
        for name in sorted(expr.free_symbols, key=str):
            inner = self._of_name(name, wrt)
            if inner != 0:
                total += sp.diff(expr, name) * inner
        return total

    def _of_name(self, name: sp.Symbol, wrt: sp.Symbol) -> sp.Expr:
        if name == wrt:
            return sp.S.One
        if name not in self._by_symbol:
            return sp.S.Zero
        key = (name, wrt)
        if key not in self._cache:
            definition = self._by_symbol[name]
            terms = [definition.partial(s) * self._of_name(s, wrt) for s in definition.arguments]
            self._cache[key] = sp.Add(*terms)
        return self._cache[key]

    def expand(self, expr: sp.Expr) -> sp.Expr:
        """`expr` with every definition substituted, for checks."""
        for definition in reversed(list(self)):
            expr = expr.subs(definition.symbol, definition.expr)
        return expr
