"""What the intermediate quantities of a tree are called in mechanics, as a program: for names in derivations.

Joints are numbered from 1 in the order of the coordinates of the tree. For joint c with all that it carries, about O_c
in its frame (notation.md, sections 3 to 5):

=============  ====================================================================================================
m, s, J        mass, first moments and Binet tensor of what joint c carries; Theta: its inertia tensor
U, Omega       at (c, a): the kinematic base functions of joint a in frame c
p, H           momentum and angular momentum of what joint c carries for a unit velocity; at (c, e): those in frame e
c, s           cosine and sine of the angle at joint a; at (a, ..., b): of the sum of these, one after the other
gamma          gravity in the frame of joint c
g, Gamma, ...  elements of what a model stores (:data:`STORED`); p.q: g_ab q'^b; L, D: factors g = L^T D L
omega, ...     of :mod:`.glossary_motions`
=============  ====================================================================================================
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay
from substructures.expr.trigonometry import cos_sin
from substructures.mechanics.composite_form import Inertia, JointMomentum
from substructures.mechanics.evaluation_frames import form_before, momentum_before
from substructures.mechanics.factorisation import factor_operations, factorised
from substructures.mechanics.frame_choice import REACH
from substructures.mechanics.kinematics import Link
from substructures.mechanics.linear3 import IDENTITY, ZERO, Scalar, Vector
from substructures.part.outputs import over_formulas
from substructures.part.part import Part
from substructures.tree.assembly import assemble
from substructures.tree.coupling import couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.given.driven import every_coordinate, put_in
from substructures.tree.given.ignored import at_zero
from substructures.tree.glossary_motions import Glossary, inverse_terms, matrix, vector, velocity_terms
from substructures.tree.grouping import Admitted, every, numbers
from substructures.tree.inertial import planned
from substructures.tree.model_outputs import rate_symbols
from substructures.tree.mounted_part import WORLD, MountedPart, PlacedPart, joint_position

TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
#: joints of which sums of angles are named
MOST_ANGLES = 40
#: cosines and sines of sums of so many angles at most
LONGEST = 8
#: letters of stored outputs
STORED = {"metric": "g", "christoffel": "Gamma", "nonlinear_effects": "h", "forces": "Q"}
#: of which the right sides of the equations of motion are made
OTHERS = ("forces", "gravity", "nonlinear_effects")
#: operations of the factors of a metric that are named
MOST_FACTORS = 20_000


def glossary(spec: TreeSpec, parts: Mapping[str, Part], group: bool = False, model: Program | None = None) -> Program:
    """Outputs ``letter numbers component``, for example ``U 3.1 x``, each a scalar, over the symbols of the model.

    ``group``: as :func:`substructures.tree.couple.couple`; ``model``: its program, for names of what it stores. Raises
    InvalidDocument.
    """
    assembly = assemble(spec, parts)
    admitted = every if group else numbers
    found, placed, chain = _carried_by_joints(assembly.scope.graph, assembly.mounted, assembly.gravity, admitted)
    rates, accelerations = rate_symbols(assembly)
    momenta = [momentum for here in placed for momentum in here.evaluated.momenta]
    found |= velocity_terms(placed, chain, momenta, rates)
    found |= inverse_terms(placed, chain, rates, accelerations)
    if model is not None:
        own = (rates[m.first + c] for m in assembly.mounted for c in m.part.topology.movers)
        given = {**spec.driven, **spec.ignored, **assembly.dependent.values}
        free = [x for name, x in zip(every_coordinate(assembly), own, strict=True) if name not in given]
        found |= _stored(assembly.scope.graph, model, free)
    of_loads = {} if model is None else {symbol.name: symbol for symbol in model.symbols}
    outputs = at_zero(assembly, put_in(assembly, _written(found)))
    return program(assembly.scope.graph, outputs, {**of_loads, **assembly.scope.symbols})


def part_glossary(part: Part) -> Program:
    """The same of a part by itself, over its own symbols."""
    alone = MountedPart(part, WORLD, 0, IDENTITY, ZERO, {}, 0)
    known = {symbol.name: symbol for symbol in part.program.symbols}
    graph = Graph()
    found, _, _ = _carried_by_joints(graph, [alone], ZERO, numbers)
    return program(graph, _written(found), known)


def _carried_by_joints(
    graph: Graph, mounted: Sequence[MountedPart], gravity: Vector, group: Admitted
) -> tuple[Glossary, Sequence[PlacedPart], Sequence[Link]]:
    """What has a name whatever moves, the parts in their places and the links of the tree."""
    run = over_formulas(graph)
    placed = couple_parts(run, mounted, gravity, False, group=group).placed
    chain = planned(run, mounted, False, True).chain
    found = _angles(placed, graph)
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta):
            found |= {**_carried(chain, here.first + c, momentum), **_of_body(here, c), **_columns(here, c)}
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta, here.first):
            found |= _momenta(chain, c, momentum) | vector("gamma", (c,), here.gamma[c - here.first])
    return found, placed, chain


def _written(found: Glossary) -> dict[str, Formulas]:
    return {
        " ".join((letter, ".".join(str(k + 1) for k in joints), component)).rstrip(): Formulas((), {(): x})
        for (letter, joints, component), x in found.items()
        if isinstance(x, Expr) and not x.is_number and x.op != "sym"
    }


def _momenta(chain: Sequence[Link], c: int, momentum: JointMomentum) -> Glossary:
    """p and H of a joint, and those in the frames that they may be carried to."""
    p, H, e = momentum.p, momentum.H, c
    K = momentum.matrix()
    found = {**vector("p", (c,), p), **vector("H", (c,), H), **matrix("K", (c,), K)}
    for _ in range(REACH):
        if chain[e].parent < 0:
            break
        K = form_before(chain[e], chain[e].rotation.back(p), K)
        p, H = momentum_before(chain[e], p, H)
        e = chain[e].parent
        found |= {**vector("p", (c, e), p), **vector("H", (c, e), H), **matrix("K", (c, e), K)}
    return found


def _of_body(here: PlacedPart, c: int) -> Glossary:
    """First moments and Binet tensor of a body alone."""
    own = here.evaluated.inertias.get(c, Inertia())
    tensor = zip(TENSOR, own.J, strict=True)
    return vector("S", (here.first + c,), own.s) | {("B", (here.first + c,), name): x for name, x in tensor}


def _carried(chain: Sequence[Link], c: int, momentum: JointMomentum) -> Glossary:
    """Mass and moments of what a joint carries."""
    inertia: Inertia = momentum.composite
    found: Glossary = {("m", (c,), ""): inertia.m, **vector("s", (c,), inertia.s)}
    found |= {("J", (c,), name): x for name, x in zip(TENSOR, inertia.J, strict=True)}
    xx, yy, zz = inertia.J[:3]
    moments = {"xx": yy + zz, "yy": zz + xx, "zz": inertia.about_third_axis}
    found |= {("Theta", (c,), name): x for name, x in moments.items()}
    back, place = inertia.turned_back(chain[c].rotation), (c, chain[c].parent)
    found |= vector("s.e", place, back.s)
    return found | {("J.e", place, x): y for x, y in zip(TENSOR, back.J, strict=True)}


def _stored(graph: Graph, model: Program, rates: Sequence[Expr]) -> Glossary:
    """Elements of stored outputs, generalised momenta, and factors of the metric."""
    names = [name for name in (*STORED, "gravity") if name in model.outputs]
    outputs = replay(model, graph, {}, names)
    found: Glossary = {
        (STORED[name], index, ""): x for name, f in outputs.items() if name in STORED for index, x in f.entries.items()
    }
    metric = outputs["metric"]
    momenta = [graph.zero] * len(rates)
    for (a, b), x in metric.expanded().items():
        momenta[a] = momenta[a] + x * rates[b]
    found |= {("p.q", (a,), ""): p for a, p in enumerate(momenta)}
    if factor_operations(len(rates), metric.entries) > MOST_FACTORS:
        return found
    with suppress(ZeroDivisionError):
        factors = factorised(len(rates), {i: x for i, x in metric.entries.items() if isinstance(x, Expr)})
        found |= {("D", (k,), ""): x for k, x in enumerate(factors.pivots)}
        found |= {("L", (k, i), ""): x for k, row in enumerate(factors.below) for i, x in row.items()}
        # y = L^-T (Q - h) from the last to the first, as forward dynamics forms it
        y = [_others(outputs, a) for a in range(len(rates))]
        for k, row in reversed(list(enumerate(factors.below))):
            found[("y", (k,), "")] = y[k]
            for i, x in row.items():
                y[i] = y[i] - x * y[k]
    return found


def _others(outputs: Mapping[str, Formulas], a: int) -> Scalar:
    """Q_a without gravity less h_a, of what is there."""
    Q, weight, h = (outputs[name].entries.get((a,), 0) if name in outputs else 0 for name in OTHERS)
    return Q - weight - h


def _columns(here: PlacedPart, c: int) -> Glossary:
    found: Glossary = {}
    for a, twist in here.columns[c].items():
        place = (here.first + c, a)
        found |= {**vector("Omega", place, twist.Omega), **vector("U", place, twist.U)}
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
            if not (joint.s or joint.is_rate):
                yield here.first + c, joint_position(graph, here.mounted, c)
