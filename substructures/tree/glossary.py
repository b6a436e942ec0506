"""What the intermediate quantities of a tree are called in mechanics, as a program: for names in derivations.

Joints are numbered from 1 in the order of the coordinates of the tree. For joint c with all that it carries, about O_c
in its frame (notation.md, sections 3 to 5):

=============  ====================================================================================================
m, s, J        mass, first moments and Binet tensor of what joint c carries; Theta: its moment about the axis
U, Omega       at (c, a): the kinematic base functions of joint a in frame c
p, H           momentum and angular momentum of what joint c carries for a unit velocity; at (c, e): those in frame e
c, s           cosine and sine of the angle at joint a; at (a, ..., b): of the sum of these, one after the other
=============  ====================================================================================================
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, Program, program
from substructures.expr.trigonometry import cos_sin
from substructures.mechanics.composite_form import Inertia, JointMomentum
from substructures.mechanics.evaluation_frames import momentum_before
from substructures.mechanics.frame_choice import REACH
from substructures.mechanics.kinematics import Link
from substructures.mechanics.linear3 import IDENTITY, ZERO, Scalar, Vector
from substructures.part.outputs import over_formulas
from substructures.part.part import Part
from substructures.tree.assembly import assemble
from substructures.tree.coupling import couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.grouping import Admitted, every, numbers
from substructures.tree.inertial import planned
from substructures.tree.mounted_part import WORLD, MountedPart, PlacedPart

AXES = "xyz"
TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
#: joints of which sums of angles are named
MOST_ANGLES = 40
#: cosines and sines of sums of so many angles at most
LONGEST = 8

#: by (letter, numbers of joints, component), in the order in which names are taken
Glossary = dict[tuple[str, tuple[int, ...], str], Scalar]


def glossary(spec: TreeSpec, parts: Mapping[str, Part], group: bool = False) -> Program:
    """Outputs ``letter numbers component``, for example ``U 3.1 x``, each a scalar, over the symbols of the model.

    ``group``: as :func:`substructures.tree.model.couple`. Raises InvalidDocument.
    """
    assembly = assemble(spec, parts)
    admitted = every if group else numbers
    return _glossary(assembly.scope.graph, assembly.mounted, assembly.gravity, admitted, assembly.scope.symbols)


def part_glossary(part: Part) -> Program:
    """The same of a part by itself, over its own symbols."""
    alone = MountedPart(part, WORLD, 0, IDENTITY, ZERO, {}, 0)
    known = {symbol.name: symbol for symbol in part.program.symbols}
    return _glossary(Graph(), [alone], ZERO, numbers, known)


def _glossary(
    graph: Graph, mounted: Sequence[MountedPart], gravity: Vector, group: Admitted, symbols: Mapping[str, Symbol]
) -> Program:
    run = over_formulas(graph)
    placed = couple_parts(run, mounted, gravity, False, group=group).placed
    chain = planned(run, mounted, False, True).chain
    found = _angles(placed, graph)
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta):
            found |= {**_carried(here.first + c, momentum), **_columns(here, c)}
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta, here.first):
            found |= _momenta(chain, c, momentum)
    outputs = {
        " ".join((letter, ".".join(str(k + 1) for k in joints), component)).rstrip(): Formulas((), {(): x})
        for (letter, joints, component), x in found.items()
        if isinstance(x, Expr) and not x.is_number and x.op != "sym"
    }
    return program(graph, outputs, dict(symbols))


def _momenta(chain: Sequence[Link], c: int, momentum: JointMomentum) -> Glossary:
    """p and H of a joint, and those in the frames that they may be carried to."""
    p, H, e = momentum.p, momentum.H, c
    found = {**_vector("p", (c,), p), **_vector("H", (c,), H)}
    for _ in range(REACH):
        if chain[e].parent < 0:
            break
        p, H = momentum_before(chain[e], p, H)
        e = chain[e].parent
        found |= {**_vector("p", (c, e), p), **_vector("H", (c, e), H)}
    return found


def _vector(letter: str, joints: tuple[int, ...], vector: Vector) -> Glossary:
    return {(letter, joints, axis): x for axis, x in zip(AXES, vector, strict=True)}


def _carried(c: int, momentum: JointMomentum) -> Glossary:
    """Mass and moments of what a joint carries."""
    inertia: Inertia = momentum.composite
    found: Glossary = {("m", (c,), ""): inertia.m, **_vector("s", (c,), inertia.s)}
    found |= {("J", (c,), name): x for name, x in zip(TENSOR, inertia.J, strict=True)}
    return found | {("Theta", (c,), "zz"): inertia.about_third_axis}


def _columns(here: PlacedPart, c: int) -> Glossary:
    found: Glossary = {}
    for a, twist in here.columns[c].items():
        place = (here.first + c, a)
        found |= {**_vector("Omega", place, twist.Omega), **_vector("U", place, twist.U)}
    return found


def _angles(placed: Sequence[PlacedPart], graph: Graph) -> Glossary:
    """Of revolute joints, and of sums of those that follow each other."""
    found: Glossary = {}
    turning: list[tuple[int, Expr]] = []
    for a, expr in _coordinates(placed, graph):
        turning = [*turning, (a, expr)][-LONGEST:]
        for k in range(len(turning)):
            some = turning[k:]
            joints = tuple(joint for joint, _ in some)
            if len(joints) > 1 and a >= MOST_ANGLES:
                continue
            cosine, sine = cos_sin(graph.sum(x for _, x in some))
            found |= {("c", joints, ""): cosine, ("s", joints, ""): sine}
    return found


def _coordinates(placed: Sequence[PlacedPart], graph: Graph) -> Iterator[tuple[int, Expr]]:
    for here in placed:
        for c, joint in enumerate(here.part.topology.joints):
            if not joint.s:
                bound = here.mounted.bindings.get(joint.coordinate)
                yield here.first + c, graph.symbol(joint.coordinate) if bound is None else graph.lift(bound)
