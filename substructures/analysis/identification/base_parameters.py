"""Base inertial parameters: the combinations of the standard ones that motion and forces depend on, exactly.

Inverse dynamics is Y(q, q', q'') pi. Columns of Y are linearly dependent: with an independent set Y_B, as far left as
possible, the others are Y_D = Y_B C with constant C, and

    Y pi = Y_B beta,        beta = pi_B + C pi_D

(M. Gautier and W. Khalil, Direct calculation of minimum set of inertial parameters of serial robots, IEEE Transactions
on Robotics and Automation 6(3), 1990; H. Mayeda, K. Yoshida and K. Osuka, Base parameters of manipulator dynamic
models, the same issue). The parts of Y that are quadratic in q' are Christoffel symbols of the parts linear in q'', so

    Y c = 0 for all q, q', q''    if and only if    sum_i c_i g^i_ab(q) = 0  and  sum_i c_i G_ai(q) = 0

with the metric g^i and the gravity forces G_i of parameter i put to one: functions of q alone, whose dependencies
are found by :mod:`.dependencies`, most of them from what joints do not move
(:mod:`substructures.quantities.regrouping`). C is a function of the kinematic parameters that are free, and these count
as general: bind parameters to numbers where special ones (a zero, a right angle) matter.

Drives add columns: ``armature`` q'' [kg m^2, kg], ``viscous`` q' [N m s, N s/m], ``coulomb`` sign(q') [N m, N] and
``offset`` 1 [N m, N] of every joint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from flint import arb, ctx

from substructures.analysis.equations.dependencies import Dependencies, dependencies
from substructures.analysis.identification.columns import Columns
from substructures.certificate.compare import compare
from substructures.certificate.derived.regressed import base_outputs
from substructures.certificate.outputs import Outputs
from substructures.certificate.states import states_between
from substructures.certificate.stored import operations_in_balls
from substructures.errors import InvalidArgument, TooLarge, VerificationFailed, meant
from substructures.expr.direct import ball
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, Symbol, array, operands, program
from substructures.expr.replay import replay
from substructures.expr.rings.expand import expand
from substructures.expr.walk import reachable, transfer
from substructures.mechanics.state_names import BallRow
from substructures.printers import entries
from substructures.quantities.regressor_model import RegressorModel
from substructures.tree.cuts import require_open
from substructures.tree.document import require_undriven

DRIVES = ("armature", "viscous", "coulomb", "offset")
#: terms of a coefficient that is written in its canonical form
READABLE = 50
#: bits of numbers that are written
DIGITS = 256


@dataclass(frozen=True, repr=False)
class BaseParameters:
    """beta, its regressor, and how it consists of the standard parameters.

    ``program``: outputs ``base_regressor`` (n, b), ``grouping`` (b, p): [1 C] in the order of the standard parameters,
    beta = grouping pi, and ``base_parameters`` (b,): beta as a function of the free parameters (drives have no formulas
    and count as zero there). ``standard``, ``units``: names and units of all p standard parameters; ``base``: numbers
    of those that stand for a base parameter each; ``unseen``: names of those that have no influence at all.
    """

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    standard: tuple[str, ...]
    units: tuple[str, ...]
    base: tuple[int, ...]
    unseen: tuple[str, ...]
    drives: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    balls: tuple[BallRow, ...] = field(default=(), hash=False)

    def __repr__(self) -> str:
        sizes = f"base={self.count}, standard={len(self.standard)}, unseen={len(self.unseen)}"
        return f"BaseParameters({sizes}, joints={len(self.coordinates)})\n{', '.join(self.names)}"

    @property
    def count(self) -> int:
        """The number b of base parameters."""
        return len(self.base)

    @property
    def names(self) -> tuple[str, ...]:
        """The standard parameters by which the base parameters are named."""
        return tuple(self.standard[i] for i in self.base)

    def combinations(self) -> dict[str, dict[str, str]]:
        """Every base parameter as a sum: coefficient (text) by standard parameter; long ones without parameters, as
        lengths and angles in decimals make them, are numbers of 17 digits. Raises TooLarge for other long ones.
        """
        found: dict[str, dict[str, str]] = {name: {} for name in self.names}
        for entry in entries(with_short_numbers(self.program.select(["grouping"])), "grouping", "text"):
            b, i = entry["index"]
            found[self.names[b]][self.standard[i]] = str(entry["formula"])
        return found


def with_short_numbers(given: Program) -> Program:
    """The program for people, with numbers of 17 digits for operations without symbols that are long when they stand
    alone.
    """
    constant, size = list[bool](), list[int]()
    for operation in given.operations:
        used = operands(operation)
        constant.append(operation[0] != "sym" and all(constant[i] for i in used))
        size.append(1 + sum(size[i] for i in used))
    long = [i for i, n in enumerate(size) if constant[i] and n > READABLE]
    if not long:
        return given
    with ctx.workprec(DIGITS):
        values = operations_in_balls(given, {symbol.name: arb(0) for symbol in given.symbols})
    operations = list(given.operations)
    for i in long:
        number = Fraction(repr(float(values[i])))
        operations[i] = ("rat", str(number.numerator), str(number.denominator))
    return replace(given, operations=tuple(operations)).select(list(given.outputs))


def base_parameters(Y: RegressorModel, drives: Sequence[str] = ()) -> BaseParameters:
    """The base parameters beta of a tree, from its regressor; ``drives``: some of DRIVES.

        Y(q, q', q'') pi = Y_B beta,        beta = [1 C] pi

    with constant [1 C] (b, p). Raises InvalidInput for an unknown drive (``/drives/i``) and for closures, TooLarge
    (size, limit). Source: M. Gautier and W. Khalil, 1990 (see above).
    """
    require_open(Y.closures, "use the regressor, whose forces actuators and reactions of the closures balance together")
    if Y.followed:
        names = ", ".join(f"'{name}'" for name in Y.followed)
        message = f"base parameters are not told by formulas of steps of Newton's method, which meet {names}"
        raise InvalidArgument.at("", "has-closures", f"{message}: take the tree with 'level': 'full'")
    require_undriven(Y.driven, "take the tree without 'driven', or the regressor")
    for i, name in enumerate(drives):
        if name not in DRIVES:
            message = f"{name[:40]!r} is not one of {', '.join(DRIVES)}{meant(name, DRIVES)}"
            raise InvalidArgument.at(f"/drives/{i}", "unknown-drive", message)
    columns = Columns(Y, tuple(dict.fromkeys(drives)))
    found = dependencies(columns.functions())
    result = _program(Y, columns, found)
    result = result.marked(_certify(Y, columns, found.base, result))
    unseen = tuple(columns.names[j] for j, c in found.others.items() if not c)
    used = {symbol.name for symbol in result.symbols}
    parameters = {name: value for name, value in Y.parameters.items() if name in used}
    own = Y.coordinates, Y.joints, columns.names, columns.units
    return BaseParameters(result, *own, found.base, unseen, columns.drives, parameters, Y.balls)


def _certify(Y: RegressorModel, columns: Columns, base: Sequence[int], result: Program) -> list[str]:
    """Raise VerificationFailed unless Y = Y_B [1 C], by the certified regressor; returns what cannot be judged."""
    kinds = {s.name: s.kind for s in (*Y.program.symbols, *result.symbols)}
    for name in Y.coordinates:
        kinds |= {f"{name}'": "velocity", f"{name}''": "acceleration"}

    def expected(values: Mapping[str, Any]) -> Outputs:
        """At a state."""
        return base_outputs(Y.program, result, Y.coordinates, base, columns.drives, values)

    given = {name: parameter.get("value") for name, parameter in Y.parameters.items()}
    defaults = {name: ball(value, precision=1100) for name, value in given.items() if value is not None}
    try:
        found = compare(result, kinds, expected, defaults, states_between(result.operations, Y.program.operations))
    except VerificationFailed as error:
        raise VerificationFailed(f"base_parameters: {error}") from None
    return list(result.outputs) if Y.program.not_judged else found.not_judged


def _program(Y: RegressorModel, columns: Columns, found: Dependencies) -> Program:
    """The three outputs, with coefficients in their canonical form."""
    # constants first: no coefficient may be written in the coordinates of an equal node of Y
    graph, place = Graph(), {b: k for k, b in enumerate(found.base)}
    grouping: dict[tuple[int, ...], Expr | int] = {(k, b): graph.one for b, k in place.items()}
    readable = _Readable(graph)
    for j, coefficients in found.others.items():
        grouping |= {(place[b], j): readable.of(c) for b, c in coefficients.items()}
    pi = replay(Y.program, graph, {}, ["inertial_parameters"])["inertial_parameters"].entries
    beta = [graph.zero] * len(place)
    # beta = [1 C] pi
    for (k, i), c in grouping.items():
        beta[k] = beta[k] + c * (pi.get((i,), 0) + graph.zero)
    full = columns.full(graph).items()
    Y_B: dict[tuple[int, ...], Expr | int] = {(a, place[i]): x for (a, i), x in full if i in place}
    symbols = {s.name: s for s in Y.program.symbols}
    for name, joint in zip(Y.coordinates, Y.joints, strict=True):
        unit = "m" if joint == "P" else "rad"
        symbols[f"{name}'"] = Symbol(f"{name}'", "velocity", f"{unit}/s")
        symbols[f"{name}''"] = Symbol(f"{name}''", "acceleration", f"{unit}/s^2")
    outputs = {
        "base_regressor": Formulas((columns.n, len(place)), Y_B),
        "grouping": Formulas((len(place), len(columns.names)), grouping),
        "base_parameters": array((len(place),), lambda k: beta[k]),
    }
    return program(graph, outputs, symbols)


class _Readable:
    """Formulas in ``graph``, in their canonical form where it is small; they share most of what they consist of."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self._large: set[Expr] = set()
        self._moved: dict[Expr, Expr] = {}

    def of(self, x: Expr) -> Expr:
        """One of them."""
        if self._large.isdisjoint(reachable([x])):
            try:
                return expand(x, READABLE, self._large).to_expr(self.graph)
            except TooLarge:
                self._large.add(x)
        return transfer([x], self.graph, {}, self._moved)[0]
