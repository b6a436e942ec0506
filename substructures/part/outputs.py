"""What the stored program of a part gives for values of its symbols: over formulas, floats or arrays alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from substructures.certificate.compare import compare
from substructures.certificate.rebuilt import own_outputs
from substructures.certificate.states import states_between
from substructures.certificate.written import defaults_of, plain
from substructures.expr.graph import Graph
from substructures.expr.program import Formulas, Program
from substructures.expr.program import program as collect
from substructures.expr.replay import replay
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import INTERFACE, Link, constant_rotation
from substructures.mechanics.linear3 import (
    IDENTITY,
    ZERO,
    Matrix,
    Planar,
    Rotation,
    Scalar,
    Turn,
    Vector,
    add,
    apply,
    multiply,
    packed,
    transpose,
)
from substructures.part.part import Part

#: outputs with the own inertia of all carriers
OWN_INERTIA = ("inertia.m", "inertia.s", "inertia.J", "base.m", "base.s", "base.J")


@dataclass(frozen=True)
class PartOutputs:
    """Outputs by name; elements that are structurally zero are the integer 0."""

    formulas: Mapping[str, Formulas]

    def entries(self, name: str) -> Mapping[tuple[int, ...], Scalar]:
        """The elements of an output that are not structurally zero."""
        return self.formulas[name].entries

    def scalar(self, name: str, *index: int) -> Scalar:
        """One element."""
        return self.formulas[name].entries.get(index, 0)

    def vector(self, name: str, *index: int) -> Vector:
        """The last axis at an index."""
        get = self.formulas[name].entries.get
        return get((*index, 0), 0), get((*index, 1), 0), get((*index, 2), 0)

    def matrix(self, name: str, *index: int) -> Matrix:
        """The last two axes at an index."""
        return self.vector(name, *index, 0), self.vector(name, *index, 1), self.vector(name, *index, 2)

    def inertia(self, name: str, *index: int) -> Inertia:
        """m, s and J."""
        # stored as a full matrix (J_ij = J_ji), used as six entries
        tensor = packed(self.matrix(f"{name}.J", *index))
        return Inertia(self.scalar(f"{name}.m", *index), self.vector(f"{name}.s", *index), tensor)

    def own_inertia(self, carrier: int) -> Inertia:
        """What the definition fixes in a carrier, about its body frame origin (of the interface: about its own)."""
        return self.inertia("base") if carrier == INTERFACE else self.inertia("inertia", carrier)

    def rotation(self, c: int) -> Rotation:
        """E_c by its factors."""
        # E = Ehat(phi + psi), or Ehat(phi) Rx(theta)^T (turn and tilt), or one full matrix
        full = self.formulas["E.full"].entries
        if any((c, i, j) in full for i in range(3) for j in range(3)):
            return Rotation((Turn(self.matrix("E.full", c)),))
        factors = []
        # the tilt acts first: factors stand in the order in which a vector takes them
        for axis, name in ((0, "E.tilt"), (2, "E.turn")):
            cosine, sine = self.scalar(name, c, 0), self.scalar(name, c, 1)
            if (c, 0) in self.formulas[name].entries or (c, 1) in self.formulas[name].entries:
                factors.append(Planar(axis, cosine, sine))
        return Rotation(tuple(factors))


def links_of(part: Part, outputs: PartOutputs) -> tuple[Link, ...]:
    """The links of a part's joints, from its stored formulas."""
    return tuple(
        Link(j.parent, j.s, outputs.rotation(c), outputs.vector("Z", c), outputs.scalar("tau", c))
        for c, j in enumerate(part.topology.joints)
    )


def frame_placement(
    outputs: PartOutputs, frame: int, E: Matrix = IDENTITY, position: Vector = ZERO
) -> tuple[Rotation, Vector]:
    """Of what is placed in a frame of a part: rotation from the body frame of the carrier, and origin there."""
    # E E_f and r_f + E_f^T r
    E_f, r_f = outputs.matrix("frame.E", frame), outputs.vector("frame.position", frame)
    return constant_rotation(multiply(E, E_f)), add(r_f, apply(transpose(E_f), position))


#: runs the stored program of a part: the named outputs for values of its symbols, over the scalars of these values
Run = Callable[[Part, Mapping[str, Scalar], Sequence[str]], PartOutputs]


def over_formulas(graph: Graph) -> Run:
    """Stored programs as formulas in a graph; symbols without a value stand for themselves."""

    def run(part: Part, bindings: Mapping[str, Scalar], names: Sequence[str]) -> PartOutputs:
        """Replay in the graph."""
        lifted = {name: graph.lift(x) for name, x in bindings.items()}
        return PartOutputs(replay(part.program, graph, lifted, names))

    return run


def inertia_bindings(part: Part, inertias: Mapping[int, Inertia]) -> dict[str, Scalar]:
    """Values of the ten inertia symbols of every carrier that has them."""
    bindings: dict[str, Scalar] = {}
    for carrier, symbols in part.inertia_symbols.items():
        inertia = inertias[carrier]
        bindings |= zip(symbols, (inertia.m, *inertia.s, *inertia.J), strict=True)
    return bindings


def with_own_inertia(part: Part, program: Program) -> Program:
    """A program of stored formulas as they are for the part alone, with nothing mounted on it.

    The inertia symbols stand for the inertia of every body with whatever is mounted on it; binding the own values
    alone folds the program to its shortest form (notation.md, section 6).
    """
    graph = Graph()
    own = over_formulas(graph)(part, {}, OWN_INERTIA)
    bindings = inertia_bindings(part, {carrier: own.own_inertia(carrier) for carrier in part.inertia_symbols})
    known = {symbol.name: symbol for symbol in part.program.symbols}
    lifted = {name: graph.lift(x) for name, x in bindings.items()}
    result = collect(graph, replay(program, graph, lifted), known)
    graph.release()
    return result.marked(program.not_judged.union(_require_own(part, program, result)))


def _require_own(part: Part, program: Program, result: Program) -> list[str]:
    """Raise VerificationFailed unless the outputs are those of the program with the part's own inertia; returns those
    that cannot be judged.
    """
    kinds = {symbol.name: symbol.kind for symbol in part.program.symbols if symbol.kind != "inertia"}
    own, symbols = part.program, part.inertia_symbols
    found = compare(
        result,
        kinds,
        lambda values: own_outputs(program, own, symbols, values),
        defaults_of(plain(part.definition)),
        states_between(result.operations, own.operations, program.operations),
    )
    return found.not_judged
