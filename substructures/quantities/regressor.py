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
from dataclasses import dataclass, replace

from substructures.certificate.derived.regressed import regressor_outputs
from substructures.expr.program import Formulas, Program, array, program
from substructures.mechanics.composite_form import Inertia, moments_of_inertia, pairing
from substructures.mechanics.kinematics import Columns, constant_rotation, from_body
from substructures.mechanics.linear3 import SYMMETRIC_INDEX, Scalar, negate, transpose
from substructures.mechanics.newton_euler import BodyMotion, inertial_load
from substructures.mechanics.state_names import ball_rows, inertia_names
from substructures.part.outputs import PartOutputs, Run, over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.part.relations import of_coordinates
from substructures.quantities.of_parts import DYNAMIC, bare, formed
from substructures.quantities.regressor_model import RegressorModel
from substructures.quantities.regrouping import named_frames, relations
from substructures.tree.assembly import Assembly, assemble
from substructures.tree.coupling import OWN, couple_parts
from substructures.tree.document import Instance, TreeSpec
from substructures.tree.given.driven import all_coordinates, driven_names
from substructures.tree.inverse_dynamics import body_motions
from substructures.tree.model_outputs import rate_symbols
from substructures.tree.mounted_part import MountedPart, PlacedPart, ratios_of


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
