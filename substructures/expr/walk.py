"""Walks over expressions, without recursion."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping

from substructures.expr.graph import Expr, Graph
from substructures.expr.trigonometry import cos, sin, tan

_BUILD: dict[str, Callable[..., Expr]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "neg": operator.neg,
    "div": operator.truediv,
    "sin": sin,
    "cos": cos,
    "tan": tan,
    "sqrt": lambda x: x.graph.sqrt(x),
}
_INDEX = operator.attrgetter("index")


def build(graph: Graph, op: str, args: Iterable[Expr]) -> Expr:
    """The node of an operation, through the simplification of its graph."""
    make = _BUILD.get(op)
    return make(*args) if make else graph.function(op, *args)


def reachable(roots: Iterable[Expr], leaf: Callable[[Expr], bool] = lambda _: False) -> list[Expr]:
    """All nodes that the roots need, operands first. The walk does not go below a ``leaf``."""
    seen: set[Expr] = set()
    stack = list(roots)
    while stack:
        node = stack.pop()
        if node not in seen:
            seen.add(node)
            if not leaf(node):
                stack.extend(node.args)
    return sorted(seen, key=_INDEX)


def symbols_in(roots: Iterable[Expr]) -> set[str]:
    """The names of all symbols that the roots need."""
    return {str(node.value) for node in reachable(roots) if node.op == "sym"}


def transfer(
    roots: Iterable[Expr], graph: Graph, bindings: Mapping[str, Expr], new: dict[Expr, Expr] | None = None
) -> list[Expr]:
    """The roots rebuilt in another graph, symbols replaced by ``bindings`` (others by themselves); ``new``: what was
    rebuilt there before, to which this is added.
    """
    roots, new = list(roots), {} if new is None else new
    for node in reachable(roots, new.__contains__):
        if node in new:
            continue
        if node.op == "sym":
            name = str(node.value)
            new[node] = bindings[name] if name in bindings else graph.symbol(name)
        elif node.is_number:
            new[node] = graph.number(node.value)
        else:
            new[node] = build(graph, node.op, [new[a] for a in node.args])
    return [new[root] for root in roots]
