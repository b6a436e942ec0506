"""A model in a graph of its own, where further formulas are built from its outputs.

Symbols of the model keep their names: q^a is ``arm.q1``, q'^a ``arm.q1'`` and q''^a ``arm.q1''``. The order in which
nodes are made is the order of operations of the programs that come out, hence part of their digests: so outputs are
replayed and symbols become nodes when they are first asked for.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from substructures.errors import InvalidDocument
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Entries, Formulas, Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.loads.scope import Scope
from substructures.part.balls import position_rates
from substructures.quantities.stored_outputs import require_stored
from substructures.tree.model import KINEMATICS, Model

#: of coordinates by the letter of their joint
UNITS = {"R": "rad", "P": "m"}
ID = "inverse_dynamics"


class Workspace:
    """Graph, symbols and outputs of a model.

    ``zero``: symbols that are put to 0. ``symbols``: descriptions by name, to which whoever makes more symbols adds
    theirs.
    """

    def __init__(self, model: Model, zero: Iterable[str] = ()) -> None:
        self.model, self.graph, self.n = model, Graph(), model.dof
        self.zero = frozenset(zero)
        # q^a and q'^a also where no output depends on them
        self.symbols = {symbol.name: symbol for symbol in model.program.symbols}
        for name, joint in zip(model.coordinates, model.joints, strict=True):
            self.symbols[name] = Symbol(name, "coordinate", UNITS[joint])
            self.symbols[f"{name}'"] = Symbol(f"{name}'", "velocity", f"{UNITS[joint]}/s")
        # so may parameters and inputs be without effect
        for kind, declared in (("parameter", model.parameters), ("input", model.inputs)):
            for name, given in declared.items():
                self.symbols.setdefault(name, Symbol(name, kind, str(given.get("unit", ""))))
        self._found: dict[str, Entries] = {}
        #: operations of the model as they are here
        self._known: dict[int, Expr] = {}

    @cached_property
    def scope(self) -> Scope:
        """What expressions may name: positions, velocities, parameters and the time, but no inputs."""
        scope, model = Scope(self.graph, symbols=self.symbols), self.model
        for s in model.program.symbols:
            if s.kind != "input":
                scope.declare(s.name, s.kind, s.unit)
        for name, joint in zip(model.coordinates, model.joints, strict=True):
            if name in model.positions:
                scope.declare(name, "coordinate", UNITS[joint])
            scope.declare(f"{name}'", "velocity", f"{UNITS[joint]}/s")
        for name in model.positions:
            scope.declare(name, "coordinate", model.state_units["q"][name])
        for name, parameter in model.parameters.items():
            scope.declare(name, "parameter", str(parameter.get("unit", "")))
        return scope

    def independent(self, name: str, bindings: Mapping[str, Expr] | None = None) -> Entries:
        """The stored elements of an output by index; ``bindings``: expressions in place of symbols.

        Raises InvalidDocument (``division-by-zero``) when a formula divides by one of the symbols ``zero``.
        """
        found = self.formulas([name], bindings)[name].entries
        return {index: x for index, x in found.items() if isinstance(x, Expr)}

    def formulas(self, names: Sequence[str], bindings: Mapping[str, Expr] | None = None) -> dict[str, Formulas]:
        """Several outputs as they are stored. Raises as :meth:`independent`."""
        require_stored(self.model.program, names)
        bound = dict.fromkeys(self.zero, self.graph.zero) | dict(bindings or {})
        try:
            return replay(self.model.program, self.graph, bound, names, None if bindings else self._known)
        except ZeroDivisionError:
            if not self.zero:
                raise
            zeros = ", ".join(f"'{x}'" for x in sorted(self.zero & set(self.model.parameters)))
            raise InvalidDocument.at(
                "/parameters", "division-by-zero", f"a formula divides by zero when these are zero: {zeros}"
            ) from None

    def outputs(self, names: Sequence[str], bindings: Mapping[str, Expr] | None = None) -> dict[str, Entries]:
        """All non-zero elements of several outputs, those that follow from a symmetry included. Raises as
        :meth:`independent`.
        """
        found = self.formulas(names, bindings)
        return {name: _non_zero(found[name]) for name in names}

    def elements(self, name: str) -> Entries:
        """All non-zero elements of one output, which is replayed once. Raises as :meth:`independent`."""
        if name not in self._found:
            self._found[name] = self.outputs([name])[name]
        return self._found[name]

    def kinematics(self) -> dict[str, Entries]:
        """Position, rotation, U and Omega of all frames."""
        return self.outputs(KINEMATICS)

    def vector(self, name: str) -> list[Expr]:
        """An output of shape (n,), zeros included."""
        found = self.elements(name)
        return [found.get((a,), self.graph.zero) for a in range(self.n)]

    def scalar(self, name: str) -> Expr:
        """An output without axes."""
        return self.elements(name).get((), self.graph.zero)

    def velocity_symbol(self, a: int) -> Expr:
        """q'^a [rad/s, m/s]."""
        return self.graph.symbol(f"{self.model.coordinates[a]}'")

    def acceleration_symbol(self, a: int) -> Expr:
        """q''^a [rad/s^2, m/s^2]."""
        name = f"{self.model.coordinates[a]}''"
        self.symbols[name] = Symbol(name, "acceleration", f"{UNITS[self.model.joints[a]]}/s^2")
        return self.graph.symbol(name)

    def times_velocity(self, matrix: Entries) -> Entries:
        """m_ab q'^b."""
        entries: Entries = {}
        for (a, b), x in matrix.items():
            entries[(a,)] = entries.get((a,), self.graph.zero) + x * self.velocity_symbol(b)
        return entries

    def moved(self, rates: Sequence[Expr]) -> dict[str, Expr]:
        """By what a state q consists of its change at ``rates`` (n,): q', of ball joints p' = R v, Q' = Q (0, w)/2."""
        found, units = dict(zip(self.model.coordinates, rates, strict=True)), self.model.state_units["q"]
        for ball in self.model.balls:
            moving = [found.pop(name) for name in ball["velocities"]]
            self.symbols |= {name: Symbol(name, "coordinate", units[name]) for name in ball["positions"]}
            changes = position_rates(self.graph, ball["positions"], moving)
            found |= dict(zip(ball["positions"], changes, strict=True))
        return {name: found[name] for name in self.model.positions}

    @cached_property
    def displacements(self) -> list[dict[str, Expr]]:
        """Of each coordinate how a state q changes with it alone; of rates of ball joints in the axes of their body."""
        zero, one = self.graph.zero, self.graph.one
        moved = (self.moved([one if b == a else zero for b in range(self.n)]) for a in range(self.n))
        return [{name: x for name, x in changes.items() if not x.is_zero} for changes in moved]

    @cached_property
    def momenta(self) -> list[Expr]:
        """p_a = dT/dq'^a = g_ab q'^b, and g_a0 of given motions."""
        found = self.times_velocity(self.elements("metric"))
        mixed = self.elements("g_a0") if self.model.given else {}
        return [found.get((a,), self.graph.zero) + mixed.get((a,), 0) for a in range(self.n)]

    @cached_property
    def kinetic_energy(self) -> Expr:
        """T = 1/2 g_ab q'^a q'^b, and g_a0 q'^a + 1/2 g_00 of given motions; of given momenta -1/2 g_00."""
        if not self.model.ignored:
            return self._kinetic_terms
        return (self._twice_own - self.scalar("g_00")) / 2

    @cached_property
    def lagrangian(self) -> Expr:
        """L = T - V; of given momenta Routh's function T - V - p_c q'^c."""
        return self._kinetic_terms - self.scalar("potential_energy")

    @cached_property
    def _twice_own(self) -> Expr:
        """g_ab q'^a q'^b."""
        momentum = self.times_velocity(self.elements("metric"))
        return self.graph.sum(p * self.velocity_symbol(a) for (a,), p in momentum.items())

    @property
    def _kinetic_terms(self) -> Expr:
        """1/2 g_ab q'^a q'^b, and g_a0 q'^a + 1/2 g_00 of what is given."""
        if not self.model.given:
            return self._twice_own / 2
        mixed = self.graph.sum(x * self.velocity_symbol(a) for (a,), x in self.elements("g_a0").items())
        return (self._twice_own + self.scalar("g_00")) / 2 + mixed

    @property
    def time(self) -> dict[str, Expr]:
        """Rates of what changes with the time alone: the time, and driven coordinates that are inputs."""
        given = [name for name in self.model.driven if name in self.model.inputs]
        names = [(f"{name}{primes}", f"{name}{primes}'") for name in given for primes in ("", "'")]
        moving = {x: self.graph.symbol(rate) for x, rate in names if rate not in self.zero}
        return {"t": self.graph.one, **moving}

    def inverse_dynamics(self, accelerations: Sequence[Expr] | None = None) -> list[Expr]:
        """g_ab q''^b + Gamma_abc q'^b q'^c - Q_a at the symbols q'', or at other expressions for them."""
        symbols = [self.acceleration_symbol(a) for a in range(self.n)]
        qdd = symbols if accelerations is None else accelerations
        if ID in self.model.program.outputs:
            result = self.independent(ID, dict(zip((str(x.value) for x in symbols), qdd, strict=True)))
            return [result.get((a,), self.graph.zero) for a in range(self.n)]
        # models that were stored before this was one of their outputs
        rows = [self.graph.zero] * self.n
        for (a, b), x in self.elements("metric").items():
            rows[a] = rows[a] + x * qdd[b]  # g_ab q''^b
        bias, forces = self.elements("bias"), self.elements("forces")
        return [x + bias.get((a,), 0) - forces.get((a,), 0) for a, x in enumerate(rows)]

    def program(self, outputs: Mapping[str, Formulas]) -> Program:
        """Outputs as a program, which is the last that is made here: the nodes are forgotten."""
        found = program(self.graph, outputs, self.symbols)
        self.graph.release()
        return found


def momentum(coordinate: str) -> str:
    """The symbol of p_a."""
    return f"p.{coordinate}"


def _non_zero(formulas: Formulas) -> Entries:
    return {index: x for index, x in formulas.expanded().items() if isinstance(x, Expr) and not x.is_zero}


def vector(values: Sequence[Any]) -> Formulas:
    """An output of one axis."""
    return array((len(values),), lambda a: values[a])
