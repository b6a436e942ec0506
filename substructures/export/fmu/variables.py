"""The variables of a model for simulators, in the order in which their values stand in an instance.

time | q | v | der(q) | der(v) | q'' | u | p | solver_step, solver_tolerance | contacts | outputs

Of a tree v are the velocities of all coordinates, and q'' is der(v); with velocity constraints v are those of the
independent ones, der(q) = T(q) v the velocities of all, and q'' stands behind. With ball joints v are rates, and der(q)
the changes of places and quaternions.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from math import isfinite, prod
from typing import Literal

from substructures.errors import InvalidArgument, MissingValue, TooLarge
from substructures.export.contacts import CONTACTS, OF_ALL, OF_EACH
from substructures.export.exported import Exported, Function
from substructures.export.interface import Interface, Vector
from substructures.quantities.quantity import FORWARD, FRAMES, OUTPUTS, VELOCITY_DYNAMICS, Array

_NAME = re.compile(r"(der\()?[A-Za-z_]\w*(\.\w+)*\)?", re.ASCII)
#: most numbers of an instance
MOST = 100_000
TOLERANCE = 1e-8
TIME, SOLVER = "time", ("solver_step", "solver_tolerance")
#: what gives accelerations: of a tree, and with velocity constraints
MOTIONS, PRIME = (FORWARD, VELOCITY_DYNAMICS), "'"
#: what gives der(q) of ball joints
CHANGES = "position_rates"


#: an output that changes at events alone; what is zero there
Role = Literal["", "discrete", "indicator"]


@dataclass(frozen=True)
class Variable:
    """``at``: where its first number stands, which is its reference; ``of``: where that stands whose derivative it is;
    ``start``: None where it is computed.
    """

    name: str
    at: int
    causality: str
    unit: str = ""
    shape: tuple[int, ...] = ()
    start: float | None = None
    of: int | None = None
    description: str = ""
    role: Role = ""

    @property
    def size(self) -> int:
        """How many numbers."""
        return prod(self.shape)

    @property
    def variability(self) -> str:
        """As modelDescription.xml says it."""
        if self.role == "discrete":
            return "discrete"
        return "tunable" if self.causality == "parameter" else "continuous"

    def elements(self) -> Iterator[Variable]:
        """One variable for each number, ``metric[1,2]``."""
        if not self.shape:
            yield self
            return
        for k, index in enumerate(product(*(range(1, n + 1) for n in self.shape))):
            name = f"{self.name}[{','.join(map(str, index))}]"
            yield Variable(name, self.at + k, self.causality, self.unit, description=self.description)


@dataclass(frozen=True)
class Layout:
    """The variables of functions, of which one is that of the accelerations."""

    exported: Exported

    @property
    def interface(self) -> Interface:
        """What stands where in the arguments of functions."""
        return self.exported.interface

    @property
    def outputs(self) -> Sequence[Function]:
        """All functions but that of the accelerations."""
        return [each for each in self.exported.functions if each.quantity not in (*MOTIONS, CHANGES, CONTACTS)]

    @cached_property
    def motion(self) -> Function:
        """That of the accelerations."""
        return next(each for each in self.exported.functions if each.quantity in MOTIONS)

    @cached_property
    def changes(self) -> Function | None:
        """That of der(q), of trees with ball joints."""
        return next((each for each in self.exported.functions if each.quantity == CHANGES), None)

    @property
    def quaternions(self) -> list[int]:
        """Where in q each one begins."""
        return [i for i, x in enumerate(self.interface.vectors["q"].defaults) if x]

    @property
    def is_tree(self) -> bool:
        """Whether v are the velocities of all coordinates."""
        return self.motion.quantity == FORWARD

    @cached_property
    def velocities(self) -> Vector:
        """v in the order of the coordinates, by the names of their symbols."""
        if self.is_tree:
            return self.interface.vectors["qd"]
        order, found = self.interface.vectors["q"].place, self.motion.further
        places = sorted(range(len(found)), key=lambda i: order[found.names[i].removeprefix("v.")])
        return Vector("x", tuple(found.names[i] for i in places), tuple(found.units[i] for i in places))

    @cached_property
    def begins(self) -> Mapping[str, int]:
        """Where each vector begins; ``dq``, ``dv`` are derivatives, ``qd``, ``qdd`` velocities and accelerations of all
        coordinates, ``s`` parameters of the solver.
        """
        vectors = self.interface.vectors
        n, p, found, at = len(vectors["q"]), len(self.velocities), dict[str, int](), 0
        for symbol, size in (
            ("t", 1), ("q", n), ("v", p), ("dq", n), ("dv", p), ("qdd", 0 if self.is_tree else n),
            ("u", len(vectors["u"])), ("p", len(vectors["p"])), ("s", 2), ("c", len(self._contacts())), ("y", 0),
        ):  # fmt: skip
            found[symbol] = at
            at += size
        if self.is_tree:
            return {**found, "qd": found["v"], "qdd": found["dv"]}
        return {**found, "qd": found["dq"]}

    @cached_property
    def places(self) -> Mapping[str, int]:
        """Where the number of each name of a vector stands."""
        vectors = {symbol: self.interface.vectors[symbol] for symbol in ("t", "q", "qd", "qdd", "u", "p")}
        vectors |= {} if self.is_tree else {"v": self.velocities}
        return {name: self.begins[s] + i for s, vector in vectors.items() for i, name in enumerate(vector.names)}

    @cached_property
    def size(self) -> int:
        """How many numbers an instance has."""
        return self.variables[-1].at + self.variables[-1].size

    @cached_property
    def variables(self) -> list[Variable]:
        """All of them. Raises MissingValue for parameters without value, InvalidArgument for bad names, TooLarge."""
        u, p, begins = self.interface.vectors["u"], self.interface.vectors["p"], self.begins
        taken = {TIME, *SOLVER}
        found = [Variable(TIME, 0, "independent", "s"), *self._states(taken)]
        starts = u.defaults or (0.0,) * len(u)
        inputs = [_free(name.replace("''", "_dd").replace("'", "_d"), "input", taken) for name in u.names]
        found += [Variable(n, begins["u"] + i, "input", x, start=starts[i]) for i, (n, x) in _named(inputs, u.units)]
        for i, (name, unit) in _named(p.names, p.units):
            if not isfinite(p.defaults[i]):
                raise MissingValue(name)
            called = _free(name, "parameter", taken)
            found.append(Variable(called, begins["p"] + i, "parameter", unit, start=p.defaults[i]))
        told = "step of classical Runge-Kutta steps in co-simulation; 0: steps of Dormand and Prince as tolerance asks"
        found.append(Variable(SOLVER[0], begins["s"], "parameter", "s", start=0.0, description=told))
        told = "relative tolerance of adaptive steps in co-simulation, where the importer gives none"
        found.append(Variable(SOLVER[1], begins["s"] + 1, "parameter", start=TOLERANCE, description=told))
        found += [replace(each, name=_free(each.name, "output", taken)) for each in self._contacts(begins["c"])]
        found += self._outputs(taken)
        for each in found:
            if not _NAME.fullmatch(each.name):
                message = f"{each.name[:40]!r} is no name of a variable: identifiers with dots between them"
                raise InvalidArgument.at("/target", "bad-name", message)
        if found[-1].at + found[-1].size > MOST:
            raise TooLarge("the outputs of an FMU (in numbers)", found[-1].at + found[-1].size, MOST)
        return found

    def _states(self, taken: set[str]) -> Iterator[Variable]:
        """q, v, their derivatives and, where it is not among these, q''; names are added to those that are taken."""
        vectors, begins = self.interface.vectors, self.begins
        q, v = vectors["q"], self.velocities
        plain = [name.removeprefix("v.").removesuffix(PRIME) for name in v.names]
        taken.update(q.names)
        # rates of ball joints are no derivatives
        rates = [_free(f"{name}_d" if name in q.place else name, "velocity", taken) for name in plain]
        starts = q.defaults or (0.0,) * len(q)
        for i, (name, unit) in _named(q.names, q.units):
            yield Variable(name, begins["q"] + i, "output", unit, start=starts[i])
        for i, (name, unit) in _named(rates, v.units):
            yield Variable(name, begins["v"] + i, "output", unit, start=0.0)
        changes = vectors["qd"].units if self.changes is None else [f"{unit or '1'}/s" for unit in q.units]
        second = vectors["qdd"].units if self.is_tree else [f"{unit}^2" for unit in v.units]
        for symbol, of, names, units in (("dq", "q", q.names, changes), ("dv", "v", rates, second)):
            for i, (name, unit) in _named(names, units):
                yield Variable(f"der({name})", begins[symbol] + i, "local", unit, of=begins[of] + i)
        if not self.is_tree:
            second_names = [_free(f"{name}_dd", "acceleration", taken) for name in q.names]
            for i, (name, unit) in _named(second_names, vectors["qdd"].units):
                yield Variable(name, begins["qdd"] + i, "output", unit)

    def _contacts(self, begin: int = 0) -> list[Variable]:
        """What contacts do, as an instance has it."""
        told = [(f"{each.name}.{name}", unit) for each in self.exported.contacts for name, unit in OF_EACH.items()]
        told += OF_ALL.items() if self.exported.contacts else ()
        found = list[Variable]()
        for i, (name, unit) in enumerate(told):
            member = name.rpartition(".")[2]
            role: Role = "discrete" if name in OF_ALL else "indicator" if member.startswith("indicator") else ""
            causality = "local" if role == "indicator" else "output"
            found.append(Variable(f"contact.{name}", begin + i, causality, unit, role=role))
        return found

    def _outputs(self, taken: set[str]) -> Iterator[Variable]:
        at = self.begins["y"]
        for function in self.outputs:
            for name, array in function.program.outputs.items():
                told = OUTPUTS.get(name, Array(name))
                for called, shape in self._apart(told, array.shape):
                    yield Variable(_free(called, "output", taken), at, "output", told.unit, shape)
                    at += prod(shape)

    def _apart(self, told: Array, shape: tuple[int, ...]) -> Iterator[tuple[str, tuple[int, ...]]]:
        """Of poses and velocities a variable for each frame."""
        if told.axes[:1] == (FRAMES,):
            yield from ((f"{frame}.{told.name}", shape[1:]) for frame in self.interface.frames)
        else:
            yield told.name, shape


def _free(name: str, kind: str, taken: set[str]) -> str:
    """The name, behind what the variable is where another one has it, added to those that are taken."""
    while name in taken:
        name = f"{kind}.{name}"
    taken.add(name)
    return name


def _named(names: Sequence[str], units: Sequence[str]) -> Iterator[tuple[int, tuple[str, str]]]:
    return enumerate(zip(names, units, strict=True))


def layout_of(exported: Exported) -> Layout:
    """Raises InvalidArgument where there are no accelerations of a tree."""
    if all(each.quantity not in MOTIONS for each in exported.functions):
        message = "an FMU needs the accelerations of a tree: make a tree of the part, which says gravity and mounts"
        raise InvalidArgument.at("/target", "not-a-tree", message)
    if not len(exported.interface.vectors["q"]):
        raise InvalidArgument.at("/target", "no-coordinates", "nothing moves: there is nothing to be simulated")
    if exported.interface.vectors["q"].defaults and all(each.quantity != CHANGES for each in exported.functions):
        message = f"ball joints: an FMU needs the quantity '{CHANGES}', too"
        raise InvalidArgument.at("/quantities", "missing", message)
    others = (each for each in exported.functions if each.quantity not in (VELOCITY_DYNAMICS, CONTACTS))
    further = next((each for each in others if each.further.names), None)
    if further is not None:
        message = f"'{further.quantity}' depends on more than states, inputs and parameters: it is no output of an FMU"
        raise InvalidArgument.at("/quantities", "signature", message)
    return Layout(exported)
