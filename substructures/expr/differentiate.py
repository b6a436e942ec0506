"""Exact partial derivatives on the graph: forward mode, and reverse mode for products of a row and the Jacobian.

The derivatives are nodes of the same graph and therefore simplify while they are formed.

>>> from substructures.expr.trigonometry import cos, sin
>>> graph = Graph()
>>> q = graph.symbol("q")
>>> derivative(sin(q) * sin(q), "q") is sin(2 * q)
True
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

from substructures.expr.graph import Expr, Graph
from substructures.expr.powers import power_slope
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
    return directional([expr], {name: expr.graph.one})[0]


def gradient(exprs: Iterable[Expr], names: Sequence[str]) -> list[list[Expr]]:
    """Jacobian: row i, column j is the derivative of expression i with respect to symbol j."""
    rows = list(exprs)
    return in_directions(rows, [{name: rows[0].graph.one} for name in names]) if rows else []


def pullback(exprs: Iterable[Expr], weights: Iterable[Expr], names: Sequence[str]) -> list[Expr]:
    """weights_i d exprs_i / d name_j for every j, in one walk from the results to the symbols (reverse mode), for
    one expression or more.

    The cost is a small multiple of that of the expressions, for any number of names (A. Griewank and A. Walther,
    Evaluating Derivatives, 2nd ed., SIAM 2008, chapter 3). Derivatives of ``abs`` and ``sign`` as for derivative.

    >>> graph = Graph()
    >>> x, y, w = (graph.symbol(name) for name in "xyw")
    >>> pullback([x * x * y], [w], ["x", "y"]) == [2 * w * x * y, w * x * x]
    True
    """
    roots = list(exprs)
    nodes = _varied(reachable(roots), set(names))
    varied = set(nodes)
    bar: dict[Expr, Expr] = {}
    for root, weight in zip(roots, weights, strict=True):
        bar[root] = bar[root] + weight if root in bar else weight
    found: dict[str, Expr] = {}
    for node in reversed(nodes):
        w = bar.get(node)
        if w is None or w.is_zero:
            continue
        if node.op == "sym":
            found[str(node.value)] = w
        power = power_slope(node)
        if power is not None and varied.isdisjoint(power.exponent):
            shares: Iterable[tuple[Expr, Expr]] = [(power.base, w * power.slope)]
        else:
            shares = zip(node.args, _shares(node, w), strict=False)
        for x, share in shares:
            bar[x] = bar[x] + share if x in bar else share
    return [found.get(name, roots[0].graph.zero) for name in names]


def _varied(nodes: Sequence[Expr], names: Collection[str]) -> list[Expr]:
    """Those of the nodes (operands first) that depend on one of the symbols."""
    varied: dict[Expr, None] = {}
    for node in nodes:
        if any(x in varied for x in node.args) or (node.op == "sym" and node.value in names):
            varied[node] = None
    return list(varied)


def _shares(node: Expr, w: Expr) -> tuple[Expr, ...]:
    """w times the partial derivatives of a node with respect to its operands."""
    op, args = node.op, node.args
    if op == "add":
        return w, w
    if op == "sub":
        return w, -w
    if op == "neg":
        return (-w,)
    if op == "mul":
        return w * args[1], w * args[0]
    if op == "div":
        share = w / args[1]
        return share, -(share * node)
    if op == "atan2":
        y, x = args
        share = w / (x * x + y * y)
        return share * x, -(share * y)
    return (w * _OUTER[op](args[0], node),) if op in _OUTER else ()


def directional(roots: Sequence[Expr], seeds: Mapping[str, Expr]) -> list[Expr]:
    """Directional derivatives: sum over symbols of the partial derivative times ``seeds[symbol]``, in one walk.

    Raises ZeroDivisionError where a derivative is infinite for every value of the symbols.
    """
    return _along(reachable(roots), roots, seeds)


def _along(nodes: Sequence[Expr], roots: Sequence[Expr], seeds: Mapping[str, Expr]) -> list[Expr]:
    """The same; ``nodes``: those that the roots need."""
    # nodes that do not depend on the symbols have no entry
    d: dict[Expr, Expr] = {}
    for node in nodes:
        if node.op == "sym":
            if str(node.value) in seeds:
                d[node] = seeds[str(node.value)]
        elif any(a in d for a in node.args):
            power = power_slope(node)
            if power is not None and d.keys().isdisjoint(power.exponent):
                value = power.slope * d.get(power.base, node.graph.zero)
            else:
                value = step(node.graph, node, [d.get(a, node.graph.zero) for a in node.args])
            if not value.is_zero:
                d[node] = value
    return [d.get(root, root.graph.zero) for root in roots]


def in_directions(roots: Sequence[Expr], directions: Iterable[Mapping[str, Expr]]) -> list[list[Expr]]:
    """Row i, column j is the derivative of expression i in direction j, as of :func:`directional`."""
    nodes = reachable(roots)
    columns = [_along(nodes, roots, seeds) for seeds in directions]
    return [[column[i] for column in columns] for i in range(len(roots))]


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
