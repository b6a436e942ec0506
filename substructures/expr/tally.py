"""How many operations formulas need for each state, hoisted, while they are nodes of a graph.

As many as :meth:`substructures.expr.program.Program.count` finds in what :func:`substructures.expr.hoist.hoisted`
makes of them, without making it: to choose between formulas before one of them is kept.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import CONSTANT, Symbol


class Tally:
    """The operations that all entries told so far need, each of them once; ``symbols`` of the graph by name."""

    def __init__(self, graph: Graph, symbols: Mapping[str, Symbol]) -> None:
        self.graph, self.symbols = graph, symbols
        self._operations = 0
        #: by node: how often it is used, whether it depends on the state, whether it is a product with parameters
        self._uses: list[int] = []
        self._varies, self._waits, self._seen = bytearray(), bytearray(), bytearray()
        #: products with parameters that are multiplied with parameters
        self._inner: list[int] = []

    def copy(self) -> Tally:
        """One to which more can be told."""
        found = Tally(self.graph, self.symbols)
        found._operations, found._uses, found._inner = self._operations, list(self._uses), list(self._inner)
        found._varies, found._waits, found._seen = map(bytearray, (self._varies, self._waits, self._seen))
        return found

    def add(self, entries: Iterable[Expr]) -> None:
        """Tell more entries."""
        more = len(self.graph) - len(self._uses)
        self._uses += [0] * more
        for flags in (self._varies, self._waits, self._seen):
            flags.extend(bytes(more))
        for x in entries:
            self._uses[x.index] += 1
        for node in reversed(self._found()):
            self._seen[node.index] = True
            if len(node.args) == 2:
                self._add_operation(node)
            elif node.args:
                self._varies[node.index] = self._varies[node.args[0].index]
            elif node.op == "sym":
                self._varies[node.index] = self.symbols[str(node.value)].kind not in CONSTANT

    @property
    def total(self) -> int:
        """Operations for each state."""
        # a (b x): of two products for each state one is left where b x is used nowhere else
        return self._operations - sum(self._uses[i] == 1 for i in self._inner)

    def _found(self) -> list[Expr]:
        """Nodes that are needed now and were not before, operands last."""
        uses, seen, nodes, found = self._uses, self._seen, self.graph.nodes, list[Expr]()
        for i in range(len(nodes) - 1, -1, -1):
            if uses[i] and not seen[i]:
                node = nodes[i]
                found.append(node)
                for x in node.args:
                    uses[x.index] += 1
        return found

    def _add_operation(self, node: Expr) -> None:
        """An operation on two nodes."""
        i, varies = node.index, self._varies
        a, b = node.args[0].index, node.args[1].index
        if varies[a] or varies[b]:
            varies[i] = True
            self._operations += node.op != "atan2"
            if node.op == "mul" and varies[a] != varies[b]:
                self._waits[i] = True
                rest = a if varies[a] else b
                if self._waits[rest]:
                    self._inner.append(rest)
