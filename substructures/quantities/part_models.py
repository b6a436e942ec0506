"""Formulas that are derived of the parts of a tree beside its model, with what their rows are called."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar

from substructures.errors import InvalidArgument, meant
from substructures.expr.graph import Graph
from substructures.expr.known import Known
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay

#: force [N] and moment [N m] in the joint's frame, and in the axes of the world; (rows, 3) each
OUTPUTS = ("reaction_force", "reaction_moment", "reaction_force_world", "reaction_moment_world")
#: their names in an answer
FIELDS = ("force", "moment", "force_world", "moment_world")


@dataclass(frozen=True)
class OfParts:
    """Formulas with their rows along ``axis``; ``parameters``: those of the tree, by name."""

    program: Program
    rows: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    axis: ClassVar[str] = ""

    @property
    def labels(self) -> Mapping[str, Any]:
        """Names of places by axis."""
        return {self.axis: self.rows} if self.axis else {}


class ReactionModel(OfParts):
    """Reactions of a tree.

    ``program``: OUTPUTS, (rows, 3) each, functions of t, q, q', q'', inputs, free parameters, and of the multipliers
    ``lambda.<closure>.<row>`` [N, N m] of closures, ``lambda.<constraint>`` or ``lambda.<constraint>.<row>`` [N] of
    rolling contacts and knife edges. ``rows``: the joints by their coordinates, then the seats of the
    instances, ``instance.base``: what carries an instance exerts on it, in its interface frame. In the joint's frame
    the third axis is that of the joint, and the moment is about the origin of the body frame (O_k + tau e3).
    """

    axis = "joints"

    def of(self, joints: Sequence[str] | None) -> ReactionModel:
        """Of some rows alone. Raises InvalidArgument (``/joints/i``, ``unknown-joint``)."""
        if joints is None:
            return self
        return _chosen(Known(f"{self.program.digest} {self.rows}", self), read_joints(joints, self.rows))


class PowerModel(OfParts):
    """Powers of a tree. ``program``: the output ``powers`` (rows,) [W], functions of t, q, q', inputs and parameters;
    ``rows``: what each is of.
    """

    axis = "loads"


def read_joints(joints: Sequence[str] | str, rows: Sequence[str], place: str = "/joints") -> tuple[str, ...]:
    """Names of rows, each once. Raises InvalidArgument for unknown ones and for none."""
    names = [joints] if isinstance(joints, str) else joints
    if not isinstance(names, list | tuple) or not names:
        raise InvalidArgument.at(place, "missing", "a list of joints is needed")
    for i, name in enumerate(names):
        if name not in rows:
            likely = meant(str(name), rows) or f"; there are {', '.join(rows[:20])}"
            message = f"there is no joint '{str(name)[:80]}'{likely}"
            raise InvalidArgument.at(f"{place}/{i}", "unknown-joint", message)
    return tuple(dict.fromkeys(names))


@lru_cache(64)
def _chosen(known: Known, joints: tuple[str, ...]) -> ReactionModel:
    model: ReactionModel = known.source
    source, place = model.program, {model.rows.index(name): k for k, name in enumerate(joints)}
    graph = Graph()
    found = {
        name: Formulas((len(joints), 3), {(place[k], i): x for (k, i), x in all_rows.entries.items() if k in place})
        for name, all_rows in replay(source, graph, {}).items()
    }
    chosen = program(graph, found, {symbol.name: symbol for symbol in source.symbols})
    return ReactionModel(chosen, joints, model.parameters)
