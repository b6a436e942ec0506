"""What a tree can be asked: one row a quantity, from which all others read it.

A row says which program a quantity is outputs of, what its axes, units and arguments are, what it is called in
formulas and what it needs. Signatures of exports, units of FMUs, columns of tables, labels of answers, sizes, letters
and lists of names all come from here. Nothing is imported: clients and printers read the same rows.

Axes are named by the member of an answer that lists their places: ``coordinates``, ``frames`` (bodies and ports),
``columns`` (inertial parameters), ``links``, ``joints``, ``loads``, ``rows`` (of closures), ``driven`` (coordinates
whose motion is given), ``ignored`` (whose momentum is), ``positions`` (of balls), ``dependent`` ones; those of
FIXED have the same names everywhere, and digits are a length.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from math import prod
from typing import Any

MODEL, CONDITION, FORWARD = "model", "condition", "forward_dynamics"
REGRESSOR, REACTIONS, POWERS = "regressor", "reactions", "powers"
#: q', v' and q'' in independent velocities v, with velocity constraints
VELOCITY_DYNAMICS = "velocity_dynamics"
#: formulas that follow from a model by an analysis, and outputs of a part: not numbers of a tree
ANALYSIS, PART = "analysis", "part"
COORDINATES, FRAMES, DRIVEN, IGNORED = "coordinates", "frames", "driven", "ignored"
POSITIONS, DEPENDENT = "positions", "dependent"
#: axes whose places have the same names in every tree
FIXED = {"axes": ("x", "y", "z"), "momenta": ("px", "py", "pz", "Lx", "Ly", "Lz")}
#: of what is not in the table: all but further symbols
EVERYTHING = ("t", "q", "qd", "qdd", "u", "p")
_CLOSURES = ("closure.residual", "closure.jacobian", "closure.acceleration", "closure.direction")
_INTERFACE = ("f", "n", "K", "kappa", "F", "N", "composite")


@dataclass(frozen=True, slots=True)
class Array:
    """An output. ``along``: the names of its axes; ``unit``: of all elements, empty where they differ; ``field``: its
    name in an answer of several; ``symbol``: letter in LaTeX, ``raised``: how many of its first indices stand above.
    """

    name: str
    along: str = ""
    unit: str = ""
    field: str = ""
    symbol: str = ""
    raised: int = 0

    @property
    def axes(self) -> tuple[str, ...]:
        """The names of its axes."""
        return tuple(self.along.split())

    def shape(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """Lengths of the axes, by their names in ``sizes``."""
        lengths = {axis: len(names) for axis, names in FIXED.items()} | dict(sizes)
        return tuple(int(axis) if axis.isdigit() else lengths[axis] for axis in self.axes)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity: outputs of the program ``source``.

    ``arguments``: of its function in exports, without further symbols; ``requires``: arguments of an evaluation that
    it cannot do without; ``pivots``: outputs that tell whether the metric could be inverted; ``written``: the outputs
    of the model that its formulas are, where these are others; ``only``: why a tree may have none; ``options``: of its
    formulas; ``rule``: symmetry of these; ``note``: what readers must know; ``of_momenta``: a function of
    ``p.<coordinate>``, in numbers at those of the velocities; ``is_number``, ``is_formula``: what can be asked for.

    Where no other row has the same program: ``by``, the module here and the function that make it, of a model, or
    ``of_parts`` of a tree and its document; ``needs``: the outputs of the model that it is made of (certificate.md).
    """

    name: str
    source: str
    arguments: tuple[str, ...]
    arrays: tuple[Array, ...]
    requires: tuple[str, ...] = ()
    pivots: tuple[str, ...] = ()
    written: tuple[str, ...] = ()
    only: str = ""
    options: tuple[str, ...] = ()
    rule: str = ""
    note: str = ""
    of_momenta: bool = False
    is_number: bool = True
    is_formula: bool = True
    by: str = ""
    of_parts: bool = False
    needs: str = "metric bias forces"

    @property
    def function(self) -> Callable[..., Any]:
        """What makes its program, imported when it is first asked for."""
        module, _, name = self.by.partition(".")
        found: Callable[..., Any] = getattr(import_module(f"substructures.quantities.{module}"), name)
        return found

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of its outputs."""
        return tuple(array.name for array in self.arrays)

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of its arrays in an answer; empty where it is one array."""
        return tuple(array.field for array in self.arrays if array.field)

    @property
    def labelled(self) -> tuple[str, ...]:
        """The axes whose places an answer names."""
        axes = (axis for array in self.arrays for axis in array.axes)
        return tuple(dict.fromkeys(axis for axis in axes if axis not in (COORDINATES, *FIXED) and not axis.isdigit()))

    def of(self, found: Mapping[str, Any]) -> Any:
        """Its arrays among the outputs of its program: one, or several by field."""
        if self.fields:
            return {array.field: found[array.name] for array in self.arrays}
        return found[self.arrays[0].name]

    def size(self, sizes: Mapping[str, int]) -> int:
        """How many numbers it is, for lengths of axes by name."""
        return sum(prod(array.shape(sizes)) for array in self.arrays)


def _row(
    name: str, arguments: str, along: str = "", unit: str = "", symbol: str = "", raised: int = 0, **more: Any
) -> Quantity:
    """A quantity of one array, or of ``arrays``; with a program of its own name where no ``source`` is given, made by
    the function of that name in ``module``.
    """
    arrays = more.pop("arrays", (Array(name, along, unit, "", symbol, raised),))
    if "module" in more:
        more["by"] = f"{more.pop('module')}.{name}"
    return Quantity(name, more.pop("source", name), tuple(arguments.split()), arrays, **more)


_stored = partial(_row, source=MODEL)
_loops = partial(_row, source=MODEL, only="the tree has no closures")
_driven = partial(_row, source=MODEL, only="no coordinate is driven")
_given = partial(_row, source=MODEL, only="no coordinate is driven or ignored")
_moving = partial(_row, source=MODEL, only="no coordinate of a tree with closures is driven")
_made = partial(_row, source=ANALYSIS, is_number=False)
_formula = partial(_row, module="formulas")
_derivative = partial(_row, module="derivatives")
_canonical = partial(_row, module="canonical", pivots=("pivots",))
#: what given motions and momenta add to the metric
_DRIVES = "g_a0 g_00"
_H, _CANONICAL = f"metric potential_energy {_DRIVES}", f"metric bias forces {_DRIVES}"
_SECOND, _SYMMETRIC = "christoffel_second_kind", "Gamma^a_bc = Gamma^a_cb"
_RATES = tuple(Array(name, "coordinates", field=name) for name in ("coordinate_rates", "momentum_rates"))
_OF_UNIT = ("linear_momentum", "angular_momentum")
_OF_MOTION = " ".join((*_OF_UNIT, *(f"{name}_0" for name in _OF_UNIT)))
_MOMENTUM = (Array("linear", "axes", "kg m/s", "linear"), Array("angular", "axes", "kg m^2/s", "angular"))
_BINET = "Jxx is Binet's integral of x^2 dm, not the moment of inertia about the x axis: see moments_of_inertia"
_FLOATING = "the rates are vx vy vz wx wy wz of the base, in its own axes, then those of the coordinates"
_PIVOTS = ("pivots", "inertias")
_ROWS = (
    # outputs of a model (substructures.tree.model_outputs, substructures.tree.closures)
    _stored("metric", "q p", "coordinates coordinates", symbol="g"),
    _stored("christoffel", "q p", "coordinates coordinates coordinates", symbol=r"\Gamma"),
    _stored("forces", "t q qd u p", "coordinates", symbol="Q"),
    _stored("gravity", "q p", "coordinates"),
    _stored("bias", "q qd p", "coordinates"),
    _stored("nonlinear_effects", "q qd p", "coordinates", symbol="h"),
    _stored("potential_energy", "t q p", unit="J", symbol="V"),
    _stored("linear_momentum", "q p", "coordinates axes"),
    _stored("angular_momentum", "q p", "coordinates axes"),
    _stored("position", "q p", "frames axes", "m"),
    _stored("rotation", "q p", "frames axes axes"),
    _stored("U", "q p", "frames coordinates axes"),
    _stored("Omega", "q p", "frames coordinates axes"),
    _stored("limits", "p", "coordinates 2", only="no joint has limits"),
    _stored("friction", "p", "coordinates 4", only="no joint has dry friction"),
    _stored("friction_load", "p", "coordinates 2", only="no joint has friction that its load adds to"),
    _stored("position_rates", "q qd p", POSITIONS, only="no joint is a ball joint or floating: they are q'"),
    _stored("dependent", "q p", DEPENDENT, only="no instance is of the reduced level"),
    _loops("closure.residual", "q p", "rows"),
    _loops("closure.jacobian", "q p", "rows coordinates"),
    _loops("closure.acceleration", "q qd p", "rows"),
    _loops("closure.direction", "q p", "rows axes"),
    _loops("closure.alignment", "q p", "rows"),
    # of given motions and momenta (substructures.tree.given.driven, substructures.tree.given.ignored)
    _given("g_a0", "t q u p", "coordinates"),
    _given("g_00", "t q u p"),
    _given("Gamma_ab0", "t q u p", "coordinates coordinates"),
    _given("Gamma_a00", "t q u p", "coordinates"),
    _given("T_2", "t q qd u p", unit="J"),
    _given("T_1", "t q qd u p", unit="J"),
    _given("T_0", "t q u p", unit="J"),
    _driven("drive_forces", "t q qd qdd u p", DRIVEN, requires=("qdd",)),
    _driven("drive_powers", "t q qd qdd u p", DRIVEN, "W", requires=("qdd",)),
    _row("ignored_rates", "q qd p", IGNORED, source=MODEL, only="no coordinate is ignored"),
    _moving("closure.rate", "t q u p", "rows"),
    _moving("closure.drives", "t q u p", f"rows {DRIVEN}"),
    _given("linear_momentum_0", "t q u p", "axes", "kg m/s"),
    _given("angular_momentum_0", "t q u p", "axes", "kg m^2/s"),
    _given("U_0", "t q u p", "frames axes", "m/s"),
    _given("Omega_0", "t q u p", "frames axes", "rad/s"),
    _stored(
        "kinematics",
        "q p",
        arrays=(
            Array("position", "frames axes", "m", "position"),
            Array("rotation", "frames axes axes", "", "rotation"),
            Array("U", "frames coordinates axes", "", "U"),
            Array("Omega", "frames coordinates axes", "", "Omega"),
        ),
    ),
    # what follows from a model
    _row("condition", "q p", is_formula=False),
    _formula("coriolis", "q qd p", "coordinates coordinates", symbol="C", needs="christoffel"),
    _formula("inverse_dynamics", "t q qd qdd u p", "coordinates", symbol=r"\tau", requires=("qdd",)),
    _derivative("inverse_dynamics_derivative", "t q qd qdd u p", "coordinates", requires=("qdd", "along")),
    _derivative(FORWARD, "t q qd u p", "coordinates", symbol=r"\ddot{q}", pivots=_PIVOTS),
    _derivative("forward_dynamics_derivative", "t q qd u p", "coordinates", requires=("along",), pivots=_PIVOTS),
    _formula("kinetic_energy", "q qd p", unit="J", symbol="T", needs=f"metric {_DRIVES} ignored_rates"),
    _formula("lagrangian", "t q qd p", unit="J", symbol="L", needs=f"metric potential_energy {_DRIVES}"),
    _formula("generalised_momenta", "q qd p", "coordinates", needs=f"metric {_DRIVES}"),
    _formula("power", "t q qd u p", "coordinates", "W", "P", needs="forces"),
    # in numbers that of the motion, as formulas those of unit velocities
    _row("momentum", "q p", source="total_momentum", arrays=_MOMENTUM, written=_OF_UNIT),
    _formula("total_momentum", "q qd p", arrays=_MOMENTUM, is_number=False, needs=_OF_MOTION),
    _canonical("inverse_metric", "q p", "coordinates coordinates", symbol="g", raised=2, needs="metric"),
    _canonical(_SECOND, "q p", "coordinates coordinates coordinates", rule=_SYMMETRIC, needs="metric christoffel"),
    _canonical("hamiltonian", "t q p", unit="J", symbol="H", of_momenta=True, needs=_H),
    _canonical("canonical_equations", "t q u p", arrays=_RATES, of_momenta=True, needs=_CANONICAL),
    # what follows from the parts of a tree
    _row(REGRESSOR, "q qd qdd p", "coordinates columns", requires=("qdd",), by="regressor.regressor", of_parts=True),
    _row("inertial_parameters", "p", "columns", source=REGRESSOR, note=_BINET),
    _row("moments_of_inertia", "p", "links axes axes", "kg m^2", source=REGRESSOR),
    _row(
        REACTIONS,
        "t q qd qdd u p",
        arrays=(
            Array("reaction_force", "joints axes", "N", "force"),
            Array("reaction_moment", "joints axes", "N m", "moment"),
            Array("reaction_force_world", "joints axes", "N", "force_world"),
            Array("reaction_moment_world", "joints axes", "N m", "moment_world"),
        ),
        options=("joints",),
        by="reactions.reactions",
        of_parts=True,
    ),
    _row(POWERS, "t q qd u p", "loads", "W", by="powers.powers", of_parts=True),
    _row(
        "mass_centre",
        "q qd p",
        source="centroidal",
        arrays=(
            Array("mass_centre_position", "axes", "m", "position"),
            Array("mass_centre_velocity", "axes", "m/s", "velocity"),
        ),
        by="centroidal.centroidal",
        of_parts=True,
    ),
    _row("centroidal_momentum_matrix", "q p", "momenta coordinates", source="centroidal", symbol="A"),
    _row(
        "floating_metric",
        "q p",
        "rates rates",
        symbol="g",
        by="floating.floating_metric",
        of_parts=True,
        note=_FLOATING,
    ),
    _row(
        "floating_christoffel",
        "q p",
        "rates rates rates",
        symbol=r"\Gamma",
        by="floating.floating_christoffel",
        of_parts=True,
        note=_FLOATING,
    ),
    # groups of formulas, outputs of parts, and what analyses make, or exports in two stages
    _stored("closures", "q qd p", arrays=(), written=_CLOSURES, is_number=False),
    _row("interface", "q p", source=PART, arrays=(), written=_INTERFACE, is_number=False),
    *(_row(name, "q p", source=PART, is_number=False) for name in ("R", "r", "E", "Z", "tau", *_INTERFACE)),
    *(_made(name, "q p", symbol="R") for name in ("riemann", "ricci", "scalar_curvature")),
    _made("curvature", "q p"),
    _made("christoffel_second", "q p", symbol=r"\Gamma", raised=1),
    _made(VELOCITY_DYNAMICS, "t q u p", arrays=()),
    _made("base_regressor", "q qd qdd p"),
    _made("base_parameters", "p"),
    _made("prepare", "p"),
    _made("energy", " ".join(EVERYTHING), symbol="E"),
    _made("routhian", " ".join(EVERYTHING), symbol="R"),
)
#: programs beside that of the model by name, as the row that tells what makes them
PROGRAMS: dict[str, Quantity] = {row.source: row for row in _ROWS if row.by}
#: those that are formed from a model alone, and from the parts of a tree
DERIVED = tuple(name for name, row in PROGRAMS.items() if not row.of_parts)
OF_PARTS = tuple(name for name, row in PROGRAMS.items() if row.of_parts)
TABLE: dict[str, Quantity] = {row.name: row for row in _ROWS}
#: what every tree can be asked for in numbers
QUANTITIES: dict[str, Quantity] = {name: row for name, row in TABLE.items() if row.is_number and not row.only}
#: the members of answers that name places along axes
LABELS = tuple(dict.fromkeys(axis for row in _ROWS for axis in row.labelled))
#: every output by name, with what it is called, its axes and its unit
OUTPUTS: dict[str, Array] = {array.name: array for row in _ROWS for array in row.arrays}


def has_numbers(name: object) -> bool:
    """Whether this names a quantity that some tree has numbers of."""
    return isinstance(name, str) and name in TABLE and TABLE[name].is_number


def outputs_of(name: str) -> tuple[str, ...]:
    """The outputs of a model, or of a part, that a name stands for in formulas."""
    row = TABLE.get(name)
    return (name,) if row is None else row.written or row.outputs


def made_of(name: str) -> Quantity | None:
    """The row that tells what makes the program of formulas; None of what a model, a part or an analysis has."""
    row = TABLE.get(name)
    return None if row is None or row.written or not row.is_formula else PROGRAMS.get(row.source)


def askable(outputs: Iterable[str]) -> list[str]:
    """The quantities that a tree has formulas of; ``outputs``: of its model."""
    there = list(outputs)
    rows = [row for row in _ROWS if row.is_formula and row.source not in (ANALYSIS, PART)]
    found = [row.name for row in rows if made_of(row.name) or {*outputs_of(row.name)} & {*there}]
    return list(dict.fromkeys([*there, *found]))


def needs_parts(name: str) -> bool:
    """Whether a quantity needs the parts of a tree, beside its formulas."""
    return name in TABLE and TABLE[name].source in OF_PARTS


def signature(name: str) -> tuple[str, ...]:
    """The arguments of the function of a quantity or of an element of it, without further symbols."""
    row = TABLE.get(name.partition("[")[0])
    return EVERYTHING if row is None else row.arguments


def array_of(name: str) -> Array | None:
    """The array of a quantity, of ``quantity.field`` in an answer, or of an output by its name."""
    return _BY_MEMBER.get(name) or OUTPUTS.get(name)


def labels_of(name: str, told: Mapping[str, object]) -> list[list[str]]:
    """What the places along the axes of an array in an answer are called; empty where they have no names.

    ``told``: the answer, whose members list them.

    >>> labels_of("momentum.linear", {})
    [['x', 'y', 'z']]
    """
    array = array_of(name)
    return [] if array is None else [list(_labels(axis, told)) for axis in array.axes]


def _labels(axis: str, told: Mapping[str, object]) -> Iterator[str]:
    given = FIXED.get(axis) or told.get(axis, ())
    given = given.get("names", ()) if isinstance(given, Mapping) else given
    yield from map(str, given if isinstance(given, Iterable) else ())


_BY_MEMBER: dict[str, Array] = {
    f"{row.name}.{array.field}" if array.field else row.name: array
    for row in _ROWS
    if row.is_number
    for array in row.arrays
}
