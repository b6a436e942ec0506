"""The coupled model of a tree: one program of :mod:`substructures.tree.model_outputs`, and its certificate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from fractions import Fraction
from functools import cached_property
from typing import Any

from substructures.certificate.agreement import not_judged, told_figures
from substructures.errors import listed
from substructures.expr.program import Program
from substructures.mechanics.state_names import effort_units, positions_of, state_units
from substructures.tree.cuts import ClosureRows, Reduction
from substructures.tree.judge import Judge
from substructures.tree.with_numbers import with_numbers

KINEMATICS = ("position", "rotation", "U", "Omega")
AXES = ("coordinates", "joints", "frames", "limited")
LISTED = ("driven", "ignored", "velocity_constraints", "contacts", "balls", "reduced")


@dataclass(frozen=True)
class Model:
    """A coupled tree. ``frames``: names of bodies and ports in the order of the kinematic outputs; ``closures``: what
    the rows of the closure outputs are, ``reduction``: in which coordinates it moves; ``parameters``, ``inputs`` (of
    loads): all that are declared and not bound, used or not; ``limited``: the coordinates that have limits;
    ``plausibility``: of values, unknown of a model out of a store; ``driven``: coordinates whose motion is given,
    ``ignored``: whose momentum is; ``velocity_constraints``, ``contacts``: of its motions, as plain data; the formulas
    are those without; ``balls``: joints whose rates are no derivatives of coordinates;
    ``reduced``: instances whose loops are in the formulas, with their coordinates; ``numbers``: in SI, still to be
    put in for symbols of the program (:meth:`with_numbers`), ``unbound``: the model before."""

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    frames: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    certificate: Mapping[str, Any] = field(hash=False)
    closures: tuple[ClosureRows, ...] = ()
    inputs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict, hash=False)
    limited: tuple[str, ...] = ()
    plausibility: Judge | None = field(default=None, compare=False, repr=False)
    reduction: Reduction = field(default=Reduction(), hash=False)
    driven: tuple[str, ...] = ()
    velocity_constraints: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)
    numbers: Mapping[str, Fraction] = field(default_factory=dict, hash=False)
    ignored: tuple[str, ...] = ()
    contacts: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)
    balls: tuple[Mapping[str, Sequence[str]], ...] = field(default=(), hash=False)
    reduced: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)
    unbound: Model | None = field(default=None, compare=False, repr=False)

    def __repr__(self) -> str:
        """Two lines: what it is, and what its formulas take and how well they agree with the direct form."""
        loops = f"; closures {listed(rows.name for rows in self.closures)}" if self.closures else ""
        what = f"{self.dof} coordinates ({self.joints or 'none'}): {listed(self.coordinates) or 'none'}{loops}"
        return f"Model, {what}\n{told_figures(self.operations, self.certificate)}"

    @cached_property
    def operations(self) -> dict[str, int]:
        """Arithmetic operations of every output alone; ``total``: of metric, christoffel and forces together."""
        together = [name for name in ("metric", "christoffel", "forces") if name in self.program.outputs]
        return self.program.totals() | {"total": self.program.count(together)["total"]}

    def with_numbers(self) -> Model:
        """The model with its numbers in the formulas, exactly; these are made when they are first asked for."""
        if not self.numbers:
            return self
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        found = _WithNumbers(**{**given, "numbers": {}, "unbound": self})
        del vars(found)["program"]
        return found

    @cached_property
    def bound(self) -> Program:
        """The program with the ``numbers`` in the places of symbols."""
        return with_numbers(self.program, self.numbers)

    @property
    def of_shape(self) -> Model:
        """The model before its ``numbers`` were put in, whose program is that of its shape; itself without any."""
        if self.unbound is None:
            return self
        made = vars(self).get("program")
        return self.unbound if made is None or made is vars(self.unbound).get("bound") else self

    @property
    def given(self) -> tuple[str, ...]:
        """The coordinates that are driven or ignored."""
        return (*self.driven, *self.ignored)

    @property
    def dependent(self) -> tuple[str, ...]:
        """The coordinates that loops in the formulas make functions of others (reduced level)."""
        return tuple(name for level in self.reduced for name in level["dependent"])

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """What states q are: the coordinates, but of ball joints their place (x, y, z) and quaternion (w, x, y, z)."""
        return positions_of(self.coordinates, self.balls)

    @cached_property
    def units(self) -> dict[str, str]:
        """The SI units of parameters and inputs by name, actuators last; empty where none was given."""
        declared, own = {**self.parameters, **self.inputs}, effort_units(self.coordinates, self.joints)
        if self.dependent:
            own |= {s.name: s.unit for s in self.program.symbols if s.name.removeprefix("tau.") in self.dependent}
        return {name: str(given.get("unit", "")) for name, given in declared.items()} | own

    @cached_property
    def state_units(self) -> dict[str, dict[str, str]]:
        """The SI units of coordinates, velocities and accelerations, by the fields q, qd, qdd and coordinate."""
        return state_units(self.coordinates, self.joints, self.balls)

    @cached_property
    def effective(self) -> frozenset[str]:
        """The symbols that the formulas depend on."""
        return frozenset(s.name for s in self.program.symbols)

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """All inputs: those in the formulas of its shape in the order of the symbols, then those without effect."""
        named = [s.name for s in self.of_shape.program.symbols if s.kind == "input"]
        return tuple(dict.fromkeys([*named, *self.inputs, *effort_units(self.coordinates, self.joints)]))

    def described(self) -> dict[str, Any]:
        """What the axes of the outputs are, as plain data."""
        closures: dict[str, Any] = {"closures": [rows.plain() for rows in self.closures]} if self.closures else {}
        closures |= {"reduction": self.reduction.plain()} if self.reduction else {}
        closures |= {name: list(getattr(self, name)) for name in LISTED if getattr(self, name)}
        named = {"coordinates": list(self.coordinates), "joints": self.joints, "frames": list(self.frames)}
        return closures | named | {"limited": list(self.limited)}

    def summary(self) -> dict[str, Any]:
        """Plain data that is stored beside the program."""
        found = self.described() | {
            "parameters": {name: dict(p) for name, p in self.parameters.items()},
            "inputs": {name: dict(given) for name, given in self.inputs.items()},
            "certificate": dict(self.certificate),
            "operations": self.operations,
        }
        return found | ({"numbers": {name: str(x) for name, x in self.numbers.items()}} if self.numbers else {})

    @classmethod
    def load(cls, summary: Mapping[str, Any], stored: bytes | Program) -> Model:
        """A stored model, with its numbers put in; ``stored``: its program, read or not. Raises InvalidProgram."""
        names = tuple(summary["coordinates"]), str(summary["joints"]), tuple(summary["frames"])
        described = summary["parameters"], summary["certificate"]
        closures = tuple(ClosureRows.read(plain) for plain in summary.get("closures", ()))
        read = Program.from_bytes(stored) if isinstance(stored, bytes) else stored
        program = read.marked(not_judged(summary["certificate"]))
        more: dict[str, Any] = {name: tuple(summary.get(name, ())) for name in ("limited", *LISTED)}
        more |= {"numbers": {name: Fraction(x) for name, x in summary.get("numbers", {}).items()}}
        more |= {"reduction": Reduction.read(summary["reduction"])} if summary.get("reduction") else {}
        return cls(program, *names, *described, closures, summary.get("inputs", {}), **more).with_numbers()


class _WithNumbers(Model):
    """A model whose numbers are put in when its formulas are first asked for: motions go by those of the shape."""

    @cached_property
    def program(self) -> Program:  # a field, until then without a value
        """The formulas with the numbers."""
        shape = self.unbound
        assert shape is not None  # noqa: S101 -- with_numbers gives it
        return shape.bound


def no_coordinates(dof: int) -> list[dict[str, str]]:
    """Of a tree in which nothing moves."""
    message = "the tree has no coordinates: nothing moves, and metric and forces are empty"
    return [] if dof else [{"pointer": "", "code": "no-coordinates", "message": message}]
