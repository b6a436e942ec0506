"""Exact partial derivatives, forward mode on the graph.

The derivatives are nodes of the same graph and therefore simplify while they are formed.

>>> from substructures.expr.trigonometry import cos, sin
>>> graph = Graph()
>>> q = graph.symbol("q")
>>> derivative(sin(q) * sin(q), "q") is sin(2 * q)
True
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from substructures.expr.graph import Expr, Graph
from substructures.expr.trigonometry import cos, sin, tan
from substructures.expr.walk import reachable

_OUTER: dict[str, Callable[[Expr, Expr], Expr]] = {
    # derivative of f(u) with respect to u, from u and the node f(u)
    "sin": lambda u, _: cos(u),
    "cos": lambda u, _: -sin(u),
    "tan": lambda u, _: 1 + tan(u) * tan(u),
    "asin": lambda u, _: 1 / u.graph.sqrt(1 - u * u),
    "acos": lambda u, _: -1 / u.graph.sqrt(1 - u * u),
    "atan": lambda u, _: 1 / (1 + u * u),
    "exp": lambda _, f: f,
    "log": lambda u, _: 1 / u,
    "sqrt": lambda _, f: 1 / (2 * f),
    "abs": lambda u, _: u.graph.function("sign", u),
}


def derivative(expr: Expr, name: str) -> Expr:
    """Partial derivative of a scalar with respect to the symbol ``name``.

    ``abs`` has the derivative ``sign``, and ``sign`` has the derivative 0: correct where the argument is not zero; at
    its zeros there is no derivative (the jump of ``sign`` is not represented). Raises ZeroDivisionError where a
    derivative is infinite for every value of the symbols.
    """
    return _derivatives([expr], name)[0]


def gradient(exprs: Iterable[Expr], names: Sequence[str]) -> list[list[Expr]]:
    """Jacobian: row i, column j is the derivative of expression i with respect to symbol j."""
    rows = list(exprs)
    columns = [_derivatives(rows, name) for name in names]
    return [[column[i] for column in columns] for i in range(len(rows))]


def _derivatives(roots: Sequence[Expr], name: str) -> list[Expr]:
    return directional(roots, {name: roots[0].graph.one}) if roots else []


def step(graph: Graph, node: Expr, d: list[Expr]) -> Expr:
    """Derivative of a node from those of its operands."""
    op, args = node.op, node.args
    if op == "add":
        return d[0] + d[1]
    if op == "sub":
        return d[0] - d[1]
    if op == "neg":
        return -d[0]
    if op == "mul":
        return d[0] * args[1] + args[0] * d[1]
    if op == "div":
        # (u/v)' = (u' - (u/v) v') / v
        return (d[0] - node * d[1]) / args[1]
    if op == "atan2":
        y, x = args
        return (x * d[0] - y * d[1]) / (x * x + y * y)
    if op == "sign":
        return graph.zero
    return _OUTER[op](args[0], node) * d[0]


def directional(roots: Sequence[Expr], seeds: Mapping[str, Expr]) -> list[Expr]:
    """Derivatives along a direction, in one walk: the sum of d root / d name times the expression ``seeds[name]``."""
    # nodes that do not depend on the symbols have no entry and cost nothing
    d: dict[Expr, Expr] = {}
    for node in reachable(roots):
        if node.op == "sym":
            if str(node.value) in seeds:
                d[node] = seeds[str(node.value)]
        elif any(a in d for a in node.args):
            value = step(node.graph, node, [d.get(a, node.graph.zero) for a in node.args])
            if not value.is_zero:
                d[node] = value
    return [d.get(root, root.graph.zero) for root in roots]
