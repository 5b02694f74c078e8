"""Breaks a Python source on purpose, one place at a time."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from typing import Any

SWAPS: dict[type, type] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Gt: ast.Lt,
    ast.Lt: ast.Gt,
    ast.LtE: ast.Gt,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
}
EDGES: dict[type, type] = {ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Lt: ast.LtE, ast.LtE: ast.Lt}
"""The same comparison with its edge on the other side."""
CALLS = {"min": "max", "max": "min", "abs": "float"}


def mutants(source: str) -> Iterator[tuple[str, str]]:
    """Yield (what is broken, source) for each place in the functions of ``source``."""
    tree = ast.parse(source)
    for function in (n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)):
        body = [function, *(n for part in function.body for n in ast.walk(part))]
        for node in body:
            for name, change in _changes(node):
                before = dict(node.__dict__)
                change(node)
                text = ast.unparse(tree)
                node.__dict__.clear()
                node.__dict__.update(before)
                line = getattr(node, "lineno", function.lineno) - function.lineno
                yield f"{function.name} + {line}: {name}", text


def _changes(node: ast.AST) -> Iterator[tuple[str, Callable[[Any], None]]]:
    if isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp) and type(node.op) in SWAPS:
        other = SWAPS[type(node.op)]
        yield f"{type(node.op).__name__} to {other.__name__}", lambda n: setattr(n, "op", other())
    if isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPS:
        swap = SWAPS[type(node.ops[0])]
        yield f"{type(node.ops[0]).__name__} turned", lambda n: setattr(n, "ops", [swap()])
    if isinstance(node, ast.Compare) and type(node.ops[0]) in EDGES:
        edge = EDGES[type(node.ops[0])]
        yield f"edge of {type(node.ops[0]).__name__}", lambda n: setattr(n, "ops", [edge()])
    if isinstance(node, ast.If | ast.IfExp):
        yield "condition negated", lambda n: setattr(n, "test", _negated(n.test))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "sign dropped", lambda n: setattr(n, "op", ast.UAdd())
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS:
        swapped = CALLS[node.func.id]
        yield f"{node.func.id} to {swapped}", lambda n: setattr(n, "func", ast.Name(swapped))
    if isinstance(node, ast.Call) and len(node.args) > 1:
        for i in range(len(node.args)):
            yield f"argument {i} left out", _without(i)
    for name in ("body", "orelse"):
        block = getattr(node, name, None)
        if isinstance(block, list):
            yield from _left_out(name, block)
    if isinstance(node, ast.Return) and isinstance(node.value, ast.Constant):
        whole = node.value.value
        if isinstance(whole, int):
            yield f"{whole} to {1 - whole}", lambda n: setattr(n, "value", ast.Constant(1 - whole))
    if isinstance(node, ast.Constant) and isinstance(node.value, float):
        value = node.value
        yield f"{value} to {value + 1.0}", lambda n: setattr(n, "value", value + 1.0)


def _negated(test: ast.expr) -> ast.expr:
    return ast.UnaryOp(ast.Not(), test)


def _left_out(name: str, block: list[ast.stmt]) -> Iterator[tuple[str, Callable[[Any], None]]]:
    """Leave out a statement that changes something: an item, an attribute, a call."""
    for k, statement in enumerate(block):
        if isinstance(statement, ast.Assign | ast.AugAssign | ast.Expr):
            text = ast.unparse(statement).splitlines()[0]
            if text.startswith(('"', "'")):
                continue  # a docstring

            def change(n: Any, k: int = k) -> None:
                setattr(n, name, [*block[:k], ast.Pass(), *block[k + 1 :]])

            yield f"without {text}", change


def _without(index: int) -> Callable[[Any], None]:
    """Put the neighbouring argument in the place of argument ``index``."""

    def change(node: ast.Call) -> None:
        args = list(node.args)
        args[index] = args[index - 1]
        node.args = args

    return change
