"""What dependent coordinates are: formulas of independent ones, with their first and second derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from substructures.expr.graph import Expr, Graph
from substructures.expr.trigonometry import cos, linear_form, sin
from substructures.expr.walk import build, reachable, transfer
from substructures.tree.given.loops.triangle import Complex, conjugate, times

#: (coordinate, factor) of a sum of angles
Sum = frozenset[tuple[str, int]]


class NotReduced(Exception):
    """Loops that have no reduced level; says why."""


@dataclass
class Dependent:
    """What the coordinates of a part are: values of dependent ones, cosines and sines of sums of them, rows of N by
    coordinate and independent coordinate, H by coordinate and two of these; ``branches``: the signs that were taken,
    or steps of Newton's method; ``sums``: angles that are, but for turns, sums of independent ones; ``loops``: the
    coordinates that closures tell together, in the order in which they are found; ``followed``: closures that are met
    by steps from the start.

    Values and angles are formulas of independent coordinates and parameters; N and H of all coordinates.
    """

    graph: Graph
    independent: tuple[str, ...]
    values: dict[str, Expr] = field(default_factory=dict)
    angles: dict[Sum, Complex] = field(default_factory=dict)
    N: dict[str, dict[str, Expr]] = field(default_factory=dict)
    H: dict[str, dict[tuple[str, ...], Expr]] = field(default_factory=dict)
    branches: list[int] = field(default_factory=list)
    sums: dict[str, Expr] = field(default_factory=dict)
    loops: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)
    followed: list[str] = field(default_factory=list)

    def moved(self, graph: Graph, instance: str, bindings: Mapping[str, Expr]) -> Dependent:
        """In another graph, where symbols are ``bindings``, and coordinates and closures those of an instance."""
        given = [*self.values.values(), *(x for pair in self.angles.values() for x in pair)]
        given += [x for row in self.N.values() for x in row.values()]
        given += [*(x for bend in self.H.values() for x in bend.values()), *self.sums.values()]
        # all in one pass, for what they have in common; taken off below in the order in which they are given
        found = iter(transfer(given, graph, bindings))

        def inside(names: Iterable[str]) -> tuple[str, ...]:
            """As the tree calls them."""
            return tuple(f"{instance}.{name}" for name in names)

        values = {q: next(found) for q in inside(self.values)}
        angles = {
            frozenset((f"{instance}.{q}", n) for q, n in sum_): (next(found), next(found)) for sum_ in self.angles
        }
        N = {f"{instance}.{q}": {j: next(found) for j in inside(row)} for q, row in self.N.items()}
        H = {f"{instance}.{q}": {inside(pair): next(found) for pair in row} for q, row in self.H.items()}
        sums = {q: next(found) for q in inside(self.sums)}
        loops = {inside(closures): inside(z) for closures, z in self.loops.items()}
        own, followed = inside(self.independent), [*inside(self.followed)]
        return Dependent(graph, own, values, angles, N, H, list(self.branches), sums, loops, followed)

    def beside(self, other: Dependent) -> Dependent:
        """Those of both."""
        values, angles = self.values | other.values, self.angles | other.angles
        rest = self.N | other.N, self.H | other.H, self.branches + other.branches, self.sums | other.sums
        loops = self.loops | other.loops, self.followed + other.followed
        return Dependent(self.graph, self.independent + other.independent, values, angles, *rest, *loops)

    def put_in(self, roots: Sequence[Expr]) -> list[Expr]:
        """Formulas with what dependent coordinates are in their places."""
        new: dict[Expr, Expr] = {}
        for node in reachable(roots):
            if node.op == "sym":
                new[node] = self.values.get(str(node.value), node)
            elif not node.args or all(new[a] is a for a in node.args):
                new[node] = node
            elif node.op in ("cos", "sin", "tan"):
                # by the cosines that the triangle gave, so that no arc tangent is within a cosine
                c, s = self._cos_sin(node.args[0], new)
                new[node] = {"cos": c, "sin": s}.get(node.op) or s / c
            else:
                new[node] = build(self.graph, node.op, [new[a] for a in node.args])
        return [new[root] for root in roots]

    def _cos_sin(self, angle: Expr, new: Mapping[Expr, Expr]) -> Complex:
        """Of a sum of angles, by those of dependent coordinates in it."""
        terms, turns = linear_form(angle)
        turning = {name for known in self.angles for name, _ in known}
        # half of a dependent angle has no cosine in those of whole ones: its value is put in
        whole = {x: str(x.value) for x, n in terms.items() if x.op == "sym" and n.denominator == 1}
        own = {name: terms[x] for x, name in whole.items() if name in turning}
        graph = self.graph
        others = ((self.sums.get(whole.get(x, ""), new.get(x, x)), n) for x, n in terms.items())
        rest = graph.sum(
            x * graph.number(n) for (x, n), at in zip(others, terms, strict=True) if whole.get(at) not in own
        )
        rest = rest + graph.pi * graph.number(turns)
        found: Complex = cos(rest), sin(rest)
        left = {name: int(n) for name, n in own.items()}
        # sums of two first: the absolute angle of a bar is one quotient, z / |z|, its two angles are a product
        for known in sorted(self.angles, key=len, reverse=True):
            for sign in (1, -1):
                while known and all(left.get(name, 0) * n * sign > 0 for name, n in known):
                    x = self.angles[known]
                    found = times(found, x if sign > 0 else conjugate(x))
                    for name, n in known:
                        left[name] -= sign * n
        return found
