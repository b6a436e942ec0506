"""sin, cos and tan of linear combinations of angles (notation.md, sections 8.1 and 8.3).

>>> graph = Graph()
>>> q = graph.symbol("q")
>>> sin(q + graph.pi / 2) is cos(q)
True
>>> cos(graph.pi / 3)
1/2
"""

from __future__ import annotations

from fractions import Fraction

from substructures.expr.construction.fingerprint import PRIME, added, circle_point, multiplied
from substructures.expr.graph import Expr, Graph

LinearForm = tuple[dict[Expr, Fraction], Fraction]


def linear_form(x: Expr) -> LinearForm:
    """x as sum of rational multiples of atoms, and of pi."""
    terms: dict[Expr, Fraction] = {}
    turns = Fraction(0)
    stack = [(x, Fraction(1))]
    pi = x.graph.pi
    while stack:
        node, factor = stack.pop()
        if node is pi:
            turns += factor
        elif node.op in ("add", "sub"):
            stack.append((node.args[0], factor))
            stack.append((node.args[1], factor if node.op == "add" else -factor))
        elif node.op == "neg":
            stack.append((node.args[0], -factor))
        elif node.op == "mul" and node.args[0].is_number:
            stack.append((node.args[1], factor * Fraction(node.args[0].value)))
        else:
            atom, factor = (x.graph.one, factor * Fraction(node.value)) if node.is_number else (node, factor)
            terms[atom] = terms.get(atom, Fraction(0)) + factor
    return {atom: factor for atom, factor in terms.items() if factor}, turns


def _point(terms: dict[Expr, Fraction], turns: Fraction) -> tuple[int, int]:
    """(cos, sin) in the field. A fraction of an atom is an atom of its own, which only loses simplifications."""
    point = multiplied(circle_point("pi/" + str(turns.denominator)), turns.numerator, PRIME) if turns else (1, 0)
    for atom, factor in terms.items():
        base = circle_point((atom.fp, factor.denominator))
        point = added(point, multiplied(base, factor.numerator, PRIME), PRIME)
    return point


def _exact(graph: Graph, turns: Fraction) -> tuple[Expr, Expr] | None:
    """(cos, sin) of turns * pi when they are built from square roots of 2 and 3 (multiples of 15 degrees)."""
    twelfths = turns % 2 * 12
    if twelfths.denominator != 1:
        return None
    n = int(twelfths)
    return _cosine_of_twelfths(graph, n), _cosine_of_twelfths(graph, (n - 6) % 24)


def _cosine_of_twelfths(graph: Graph, n: int) -> Expr:
    n = min(n, 24 - n)
    if n > 6:
        return -_cosine_of_twelfths(graph, 12 - n)
    half, quarter = graph.number(Fraction(1, 2)), graph.number(Fraction(1, 4))
    root2, root3, root6 = (graph.sqrt(graph.number(k)) for k in (2, 3, 6))
    values = [graph.one, quarter * (root6 + root2), half * root3, half * root2, half]
    return [*values, quarter * (root6 - root2), graph.zero][n]


def _reduced(x: Expr) -> tuple[Expr, LinearForm, int]:
    """x without its multiples of pi/2, as a formula and as a linear form, and their number."""
    terms, turns = linear_form(x)
    quarters = turns * 2
    if not terms or quarters.denominator != 1 or not quarters:
        return x, (terms, turns), 0
    graph = x.graph
    rest = graph.sum(atom * graph.number(factor) for atom, factor in terms.items())
    return rest, (terms, Fraction(0)), int(quarters) % 4


def cos_sin(x: Expr) -> tuple[Expr, Expr]:
    """(cos x, sin x), exact for multiples of pi/12; multiples of pi/2 in a sum are taken out."""
    graph = x.graph
    rest, (terms, turns), quarters = _reduced(x)
    if not terms:
        exact = _exact(graph, turns)
        if exact is not None:
            return exact
    c, s = _point(terms, turns)
    cosine, sine = _node(graph, "cos", rest, c), _node(graph, "sin", rest, s)
    return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[quarters]


def _node(graph: Graph, op: str, x: Expr, fp: int) -> Expr:
    found = graph.table.get(fp)
    if found is not None and (not found.args or graph.serves(found, op, x)):
        return found
    found = graph.table.get(PRIME - fp)
    if found is not None and (not found.args or graph.serves(found, op, x)):
        return -found
    if x.op == "neg":
        return graph.node("cos", x.args, fp) if op == "cos" else -graph.node("sin", x.args, PRIME - fp)
    return graph.node(op, (x,), fp)


def cos(x: Expr) -> Expr:
    """Cosine of an angle in rad."""
    return cos_sin(x)[0]


def sin(x: Expr) -> Expr:
    """Sine of an angle in rad."""
    return cos_sin(x)[1]


def tan(x: Expr) -> Expr:
    """Tangent of an angle in rad, as sin/cos. Raises ZeroDivisionError at exact poles."""
    c, s = cos_sin(x)
    return s / c


def angle(c: Expr, s: Expr) -> Expr | None:
    """An angle of which these are written as cosine and sine; None where they are written otherwise."""
    core = c.args[0] if c.op == "neg" else c
    if core.op not in ("cos", "sin"):
        return None
    quarter = c.graph.pi / 2
    for x in (core.args[0], -core.args[0]):
        for n in range(4):
            if cos_sin(x + n * quarter) == (c, s):
                return x + n * quarter
    return None


def of_sum(first: tuple[Expr, Expr], second: tuple[Expr, Expr]) -> tuple[Expr, Expr]:
    """(cos, sin) of the sum of two angles from those of each: by the sum where both are known, else by their products.

    >>> graph = Graph()
    >>> a, b = graph.symbol("a"), graph.symbol("b")
    >>> of_sum(cos_sin(a), cos_sin(b)) == cos_sin(a + b)
    True
    """
    x, y = angle(*first), angle(*second)
    if x is not None and y is not None:
        return cos_sin(x + y)
    (c, s), (d, t) = first, second
    return c * d - s * t, s * d + c * t
