"""The regressor: what a tree's inverse dynamics is linear in (notation.md, section 7).

    Y(q, q', q'')_ai pi_i = g_ab q''^b + Gamma_abc q'^b q'^c - Q_a(gravity)

exactly, with the ten inertial parameters (m, s, J) of every rigid link in ``pi``. Armature, joint springs, dampers,
actuators and loads are not linear in them and not included.

One motion is carried outwards: omega, alpha and the acceleration a (with the interface of the tree accelerated by
-gravity) of the origin B of every body frame. By A = skew(alpha) + skew(omega)^2 each parameter, put to one alone,
gives a force f and a moment n about B: f = a for m; f = A e_i, n = e_i x a for s_i; f = 0, n = axial(A J) for J. The
load is linear, so these are its derivatives, and their virtual power is the column of Y:

    Y_ai = U_ka . f_i + Omega_ka . n_i           (U_ka: partial velocity of B; i: the parameters of the link k)

which is structurally zero where joint a does not carry k, and where the formula is the zero function.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from substructures.certificate.derived.regressed import regressor_outputs
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Formulas, Program, array, program
from substructures.mechanics.composite_form import Inertia, moments_of_inertia, pairing
from substructures.mechanics.kinematics import Columns, constant_rotation, from_body
from substructures.mechanics.linear3 import SYMMETRIC_INDEX, Scalar, negate, transpose
from substructures.mechanics.newton_euler import BodyMotion, inertial_load
from substructures.mechanics.state_names import BallRow, ball_rows, inertia_names, positions_of
from substructures.part.outputs import PartOutputs, Run, over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.part.relations import of_coordinates
from substructures.quantities.numbers.result import Evaluation, ParameterColumns, failures_of
from substructures.quantities.numbers.states import StateInput, ValueInput, read_states, symbol_values
from substructures.quantities.of_parts import DYNAMIC, bare, formed
from substructures.quantities.regrouping import named_frames, relations
from substructures.tree.assembly import Assembly, assemble
from substructures.tree.coupling import OWN, couple_parts
from substructures.tree.cuts import ClosureRows
from substructures.tree.document import Instance, TreeSpec
from substructures.tree.given.driven import all_coordinates, driven_names
from substructures.tree.inverse_dynamics import body_motions
from substructures.tree.model import Model
from substructures.tree.model_outputs import rate_symbols
from substructures.tree.mounted_part import MountedPart, PlacedPart, ratios_of

OUTPUTS = ("regressor", "inertial_parameters")


@dataclass(frozen=True)
class RegressorModel:
    """Y and pi of a tree.

    ``program``: outputs ``regressor`` (n, 10 links) [SI units per unit of the parameter], a function of q, q', q'' and
    the free parameters, ``inertial_parameters`` (10 links,), pi, and ``moments_of_inertia`` (links, 3, 3) [kg m^2],
    Theta about the origin of the body frame in its axes, with products of inertia -integral x y dm beside the diagonal;
    both functions of the free parameters.
    ``names`` and ``units``: of the columns, ``instance.body.m`` [kg], ``.sx .sy .sz`` = m times the mass centre [kg m],
    ``.Jxx .Jyy .Jzz .Jxy .Jxz .Jyz`` = integral of x x^T dm [kg m^2] (Theta = tr(J) 1 - J), about the origin of the
    body frame in its axes. A link is a moving body with all that is fixed to it in the same part; ``instance.base``
    is what is fixed to the interface of an instance on a host, in the interface frame. Massless bodies inside compound
    joints are no links. ``parameters``: the free parameters with default, unit and description. ``closures``: of the
    tree; their forces, which Y pi has to balance with the actuators, are not part of it; ``driven``: coordinates whose
    motion is given, which have no rows; ``reduced``: instances whose loops are in the formulas, ``followed``: those
    of these loops that are met by steps of Newton's method. ``regrouping``: output ``relations`` (r, 10 links + k):
    coefficients, functions of the free parameters, with which columns of Y add up to zero, whatever moves; the last k
    columns are those of massless carriers (:mod:`.regrouping`).
    """

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    regrouping: Program
    closures: tuple[ClosureRows, ...] = ()
    driven: tuple[str, ...] = ()
    balls: tuple[BallRow, ...] = field(default=(), hash=False)
    reduced: tuple[str, ...] = ()
    followed: tuple[str, ...] = ()

    @property
    def positions(self) -> tuple[str, ...]:
        """What states q are, as those of a model."""
        return positions_of(self.coordinates, self.balls)

    @property
    def labels(self) -> Mapping[str, Any]:
        """Names by axis."""
        links = tuple(name.removesuffix(".m") for name in self.names[::10])
        return {"columns": ParameterColumns(self.names, self.units), "links": links}

    def evaluate(
        self,
        q: StateInput | None,
        qd: StateInput | None = None,
        qdd: StateInput | None = None,
        *,
        parameters: ValueInput | None = None,
        limit: int | None = None,
    ) -> Evaluation:
        """Numbers: ``regressor`` (N, n, 10 links) and ``inertial_parameters`` (N, 10 links).

        Arguments as for :func:`substructures.quantities.numbers.evaluation.evaluate`; N is dropped for one state with
        ``q`` (n,). Raises InvalidArgument (``qdd`` is needed) and MissingValue.
        """
        model = Model(self.program, self.coordinates, self.joints, (), self.parameters, {}, balls=self.balls)
        given = {"q": q, "qd": qd, "qdd": qdd, "parameters": parameters}
        states = read_states(model, given, limit)
        if states.qdd is None and model.dof:
            raise InvalidArgument.at("/qdd", "missing", "the regressor needs accelerations 'qdd'")
        values = symbol_values(model, given, states, OUTPUTS)
        results = interpret_in_blocks(self.program, values, OUTPUTS, states.count)
        return Evaluation(
            self.coordinates,
            states.count,
            self.program.digest,
            {name: x[0] if states.single else x for name, x in results.items()},
            failures_of(results, lambda _name, _state: ("not-finite", "the result is not finite")),
            labels=self.labels,
            single=states.single,
        )


@dataclass(frozen=True)
class _Link:
    """A rigid link, in its body frame: own inertia, motion of B, partial velocities of B by coordinate of the tree."""

    name: str
    inertia: Inertia
    motion: BodyMotion
    columns: Columns


def regressor(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> RegressorModel:
    """The regressor of a tree of stored parts (by instance name); nothing is derived again.

    Links come in the order of instances (hosts first) and bodies, what is fixed to the interface last; pi is what the
    parts hold, bound to the tree's parameters. Raises InvalidDocument with pointers into the tree document, or TooLarge
    for more than ``max_nodes`` operations.
    """
    result, names, parameters = formed("regressor", spec, parts, _outputs, regressor_outputs, max_nodes)
    assembly, used = assemble(spec, parts), {symbol.name for symbol in result.symbols}
    free = {name: kind for name, kind in all_coordinates(assembly).items() if name not in spec.driven}
    pairs = list(zip(assembly.instances, assembly.mounted, strict=True))
    return RegressorModel(
        result,
        tuple(free),
        "".join(free.values()),
        names,
        tuple(unit for name in names[::10] for _, unit in inertia_names(name.removesuffix(".m"))),
        {name: value for name, value in parameters.items() if name in used},
        _regrouping(assembly),
        tuple(cut.rows for cut in assembly.cuts),
        driven_names(assembly),
        ball_rows(assembly.balls, [f"{i.name}.{x.coordinate}" for i, m in pairs for x in m.part.topology.joints]),
        tuple(sorted(assembly.reduced)),
        tuple(assembly.dependent.followed),
    )


def _outputs(assembly: Assembly) -> tuple[dict[str, Formulas], list[str]]:
    links = _links(over_formulas(assembly.scope.graph), assembly)
    n = sum(m.part.joint_count for m in assembly.mounted)
    Y: dict[tuple[int, ...], Scalar] = {
        (a, 10 * k + i): y for k, link in enumerate(links) for i, column in _columns(link) for a, y in column
    }
    # pi = (m, s, J) of every link, so that Y pi = g q'' + Gamma q' q' - Q(gravity)
    pi = [x for link in links for x in (link.inertia.m, *link.inertia.s, *link.inertia.J)]
    # Theta = tr(J) 1 - J
    theta = [moments_of_inertia(link.inertia.J) for link in links]
    outputs = {
        "regressor": Formulas((n, len(pi)), Y),
        "inertial_parameters": array((len(pi),), lambda i: pi[i]),
        "moments_of_inertia": array((len(links), 3, 3), lambda k, i, j: theta[k][SYMMETRIC_INDEX[i][j]]),
    }
    ratios = ratios_of(over_formulas(assembly.scope.graph), assembly.mounted)
    return of_coordinates(outputs, ratios), [name for link in links for name, _ in inertia_names(link.name)]


def _regrouping(assembly: Assembly) -> Program:
    """Relations between columns. ``assembly``: one of its own, so that no constant is written in coordinates."""
    graph = assembly.scope.graph
    # nothing that is constant depends on where the joints are
    resting = [replace(m, bindings={**m.bindings, **_resting(m.part)}) for m in assembly.mounted]
    run = bare(over_formulas(graph), (*DYNAMIC, "U", "Omega"))
    closed = {name for names in assembly.dependent.loops for name in names} - {*assembly.dependent.followed}
    loops = [cut for cut in assembly.full().cuts if cut.rows.name in closed]
    rows, columns = relations(graph, couple_parts(run, resting, (0, 0, 0), christoffel=False).placed, loops)
    entries: dict[tuple[int, ...], Scalar] = {(r, j): x for r, row in enumerate(rows) for j, x in row.items()}
    return program(graph, {"relations": Formulas((len(rows), columns), entries)}, assembly.scope.symbols)


def _resting(part: Part) -> dict[str, Scalar]:
    """A position of a part, in which nothing is turned or shifted."""
    turned = {x: int(x == ball.quaternion[0]) for ball in part.topology.balls for x in ball.positions}
    return {**dict.fromkeys(part.coordinates, 0), **turned}


def _pairs(assembly: Assembly) -> Iterator[tuple[Instance, MountedPart]]:
    return zip(assembly.instances, assembly.mounted, strict=True)


def _columns(link: _Link) -> Iterator[tuple[int, list[tuple[int, Scalar]]]]:
    """(i, [(a, Y_ai)]): virtual power of the load of every parameter put to one."""
    for i in range(10):
        # pi_j = delta_ij: m, then s = (sx, sy, sz), then J = (xx, yy, zz, xy, xz, yz)
        m, sx, sy, sz, xx, yy, zz, xy, xz, yz = (int(i == j) for j in range(10))
        load = inertial_load(link.motion, Inertia(m, (sx, sy, sz), (xx, yy, zz, xy, xz, yz)))
        # Y_ai = U_ka . f_i + Omega_ka . n_i
        yield i, [(a, pairing(twist, load.f, load.n)) for a, twist in link.columns.items()]


def _links(run: Run, assembly: Assembly) -> list[_Link]:
    """All links, and their motion in one pass outwards."""
    placed = couple_parts(bare(run), assembly.mounted, assembly.gravity).placed
    motions = body_motions(placed, *rate_symbols(assembly))
    result: list[_Link] = []
    for (instance, m), here, own_motions in zip(_pairs(assembly), placed, motions, strict=True):
        own = run(m.part, m.bindings, OWN)
        bodies = list(m.part.topology.carrier)
        result += [
            _link(f"{instance.name}.{bodies[frame]}", here, frame, own, own_motions)
            for frame in named_frames(here).values()
        ]
    return result


def _link(name: str, here: PlacedPart, frame: int, own: PartOutputs, motions: Mapping[int, BodyMotion]) -> _Link:
    """Inertia, motion and partial velocities of a carrier, in the frame of the body it is named by."""
    link = here.frame_link(frame)
    E, r = here.outputs.matrix("frame.E", frame), here.outputs.vector("frame.position", frame)
    # from the origin and axes of the link's own frame L(c) to those of the body it is named by
    inertia = own.own_inertia(link.parent).shifted(negate(r)).turned_back(constant_rotation(transpose(E)))
    # U and Omega of B by coordinate (notation.md, section 3)
    columns = here.columns_beyond(link)
    return _Link(name, inertia, motions[link.parent].at(from_body(here.links, link), link.rotation), columns)
