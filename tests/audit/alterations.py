"""The relations of the paper judged, and alterations of formulas: every number by one, every plus or minus, the whole by a factor."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from functools import cache

from umataudit import Finding, judge
from umataudit.printed import PAPER, Formula


@cache
def finding(relation_id: str) -> Finding:
    """A relation of the paper as printed, judged once for all tests."""
    return judge(PAPER[relation_id], PAPER)


def alterations(formula: Formula) -> Iterator[tuple[str, str]]:
    """(what is altered, the altered formula), one alteration at a time, in the order of the syntax tree."""
    nodes = [node for node in ast.walk(formula.tree) if isinstance(node, ast.Constant | ast.BinOp)]
    for index, node in enumerate(nodes):
        altered = copy.deepcopy(formula.tree)
        twin = [n for n in ast.walk(altered) if isinstance(n, ast.Constant | ast.BinOp)][index]
        if isinstance(node, ast.Constant):
            twin.value = node.value + 1
            yield f"{node.value} -> {twin.value} ({index})", ast.unparse(altered)
        elif isinstance(node.op, ast.Add | ast.Sub):
            twin.op = ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()
            yield f"sign of '{ast.unparse(node.right)}' ({index})", ast.unparse(altered)
    yield "factor 2", f"2*({formula.text})"
    yield "sign", f"-1*({formula.text})"
