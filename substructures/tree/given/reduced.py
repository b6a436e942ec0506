"""The reduced level of parts with loops: outputs of all coordinates as those of the independent ones (notation.md,
section 10).

With z the dependent coordinates of :mod:`substructures.tree.given.loops`, q' = N y' and q'' = N y'' + H y' y',

    g*_ij = N_ai g_ab N_bj        Gamma*_ijk = N_ai (Gamma_abc N_bj N_ck + g_ab H_bjk)        Q*_i = N_ai Q_a

and every output with an index of coordinates like Q, at z(y), z' and z''. Closures of the tree have G N for G, and
G_a H_ajk y'^j y'^k more in c. Limits and friction stay those of independent coordinates. Nothing of the tree depends on
dependent coordinates any more, but on what their actuators do, N_zi tau_z.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas
from substructures.expr.walk import transfer
from substructures.part.part import Part
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.given.projection import Projection, Terms, changed

#: what has a term more, g_ab H_bjk y'^j y'^k or G_a H_ajk y'^j y'^k
BENT = {"bias": "metric", "nonlinear_effects": "metric", "closure.acceleration": "closure.jacobian"}


def reduced(
    known: Dependent, names: Sequence[str], outputs: Mapping[str, Formulas], axes: Mapping[str, Sequence[int]]
) -> dict[str, Formulas]:
    """Outputs of all coordinates as those of the ones that do not depend on others.

    ``known``: the dependent ones; ``names``: of all coordinates; ``axes``: those of coordinates, by output.
    """
    if not known.values:
        return dict(outputs)
    level = _Reduced(known.graph, known, names)
    found = {name: level.moving(name, each, axes.get(name, ()), outputs) for name, each in outputs.items()}
    return level.written(found)


def instances_of(known: Dependent, parts: Mapping[str, Part]) -> Iterator[dict[str, Any]]:
    """The reduced instances: their coordinates, by themselves and dependent, and the closures that make them so."""
    for instance, part in parts.items():
        names = [f"{instance}.{q}" for q in part.coordinates]
        yield {
            "instance": instance,
            "independent": [q for q in names if q not in known.values],
            "dependent": [q for q in names if q in known.values],
            "closures": [f"{instance}.{each.name}" for each in part.definition.closures],
        }


class _Reduced:
    """N by its columns, and H."""

    def __init__(self, graph: Graph, known: Dependent, names: Sequence[str]) -> None:
        self.graph, self.known, self.names = graph, known, names
        self.free = [a for a, name in enumerate(names) if name not in known.values]
        place = {a: i for i, a in enumerate(self.free)}
        number = {name: a for a, name in enumerate(names)}
        self.N: list[dict[int, Expr]] = [{a: graph.one} for a in self.free]
        self.H: dict[int, list[tuple[int, int, Expr]]] = {}
        for z in known.values:
            for y, x in known.N[z].items():
                self.N[place[number[y]]][number[z]] = x
            rows = ((place[number[j]], place[number[k]], x) for (j, k), x in known.H[z].items())
            self.H[number[z]] = list(rows)
        self.projection = Projection(graph, self.N, self.free)
        speeds = [graph.symbol(f"{names[a]}'") for a in self.free]
        #: H y' y' of dependent coordinates
        self.bent = {
            a: graph.sum(x * speeds[j] * speeds[k] * (1 if j == k else 2) for j, k, x in rows)
            for a, rows in self.H.items()
        }
        # z' = N y' and z'' = N y'' + H y' y' for the symbols of dependent coordinates
        self.values: dict[str, Expr] = {}
        for mark, more in (("'", {}), ("''", self.bent)):
            moving = [graph.symbol(f"{names[a]}{mark}") for a in self.free]
            for z in known.values:
                a = number[z]
                x = graph.sum(self.N[i][a] * v for i, v in enumerate(moving) if a in self.N[i])
                self.values[f"{z}{mark}"] = x + more[a] if a in more else x

    def moving(self, name: str, each: Formulas, axes: Sequence[int], outputs: Mapping[str, Formulas]) -> Formulas:
        """An output along its axes, as formula of all coordinates."""
        entries = dict(each.expanded())
        if name in BENT:
            # before N^T, as the rest of it: N_ai g_ab H_bjk y'^j y'^k, and for closures G_a H_ajk y'^j y'^k
            entries = self.projection.sums([*entries.items(), *self._pull(outputs[BENT[name]])])
        elif not axes:
            return each
        more = self._turned(outputs["metric"]) if name == "christoffel" else ()
        return self.projection.along(name, each, axes, entries, more)

    def written(self, outputs: Mapping[str, Formulas]) -> dict[str, Formulas]:
        """Without dependent coordinates, their rates and accelerations."""
        known, graph = self.known, self.graph
        return changed(graph, outputs, lambda every: known.put_in(transfer(every, graph, self.values)))

    def _pull(self, linear: Formulas) -> Terms:
        """x_.b H_bjk y'^j y'^k."""
        return (((i,), x * self.bent[b]) for (i, b), x in linear.expanded().items() if b in self.bent)

    def _turned(self, metric: Formulas) -> Terms:
        """N_ai g_ab H_bjk."""
        for (i, b), x in self.projection.contracted(dict(metric.expanded()), 0).items():
            for j, k, bend in self.H.get(b, ()):
                # H_jk = H_kj is kept for j <= k; a set, so that j = k comes once
                yield from (((i, *both), x * bend) for both in {(j, k), (k, j)})
