"""What the regressor of a tree has to be, from its document and the definitions of its parts; and base parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import arb

from substructures.certificate.bodies import GROUND, NONE, Bodies, Frame, Moments, in_order, mass_of, massless, theta_of
from substructures.certificate.by_coordinate import of_coordinates, rates
from substructures.certificate.derived.model_at import total
from substructures.certificate.derived.model_formulas import columns_of, vector_of
from substructures.certificate.dynamics import motions, required
from substructures.certificate.linear import Ball, dot, vector, zeros
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.stored import Stored, operations_in_balls
from substructures.certificate.tree_outputs import built
from substructures.errors import VerificationFailed


@dataclass
class _Link:
    """A rigid link: the frame that it is named by, and its mass about the world's origin."""

    name: str
    frame: Frame
    moments: Moments


def regressor_outputs(
    tree: Plain, definitions: Mapping[str, Plain], names: Sequence[str], values: Mapping[str, Ball]
) -> Outputs:
    """Y and pi; ``names``: of the columns. Every column is what moves a link that has this parameter alone, put to one.

    Raises VerificationFailed for other links.
    """
    numbers, bodies, instances, _ = built(tree, definitions, values)
    links: list[_Link] = []
    for instance, inside, joints in instances:
        links += _links(bodies, definitions[instance], inside, joints, f"{instance}.")
    if [name for name in names if name.endswith(".m")] != [f"{link.name}.m" for link in links]:
        raise VerificationFailed(f"the links are not those of the documents: {', '.join(x.name for x in links)}")
    speeds, second = (rates(bodies, values, mark) for mark in ("'", "''"))
    # the world is accelerated against gravity
    moving = motions(bodies, speeds, second, numbers.vector(tree.get("gravity", NONE)) * -1)
    columns: list[list[Ball]] = []
    pi: list[Ball] = []
    theta: dict[tuple[int, ...], Ball] = {}
    for k, link in enumerate(links):
        for i in range(10):
            force, moment = required(moving[link.frame.carrier], _one(i).outwards(link.frame.A, link.frame.p))
            column = [arb(0)] * len(bodies.joints)
            for a in bodies.path(link.frame.carrier):
                column[a] = dot(bodies.joints[a].v, force) + dot(bodies.joints[a].w, moment)
            columns.append(column)
        own = link.moments.inwards(link.frame.A, link.frame.p)
        theta |= {(k, i, j): theta_of(own.J)[i, j] for i in range(3) for j in range(3)}
        pi += [own.m, *own.s.entries(), *(own.J[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))]
    result = Outputs()
    columns_of(result, "regressor", len(bodies.joints), columns)
    vector_of(result, "inertial_parameters", pi)
    result.array("moments_of_inertia", (len(links), 3, 3)).update(theta)
    return of_coordinates(result, bodies)


def _one(i: int) -> Moments:
    """m, s = (x, y, z), J = (xx, yy, zz, xy, xz, yz): one of them 1, the others 0."""
    J = zeros(3, 3)
    if i > 3:
        a, b = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))[i - 4]
        J[a, b] = J[b, a] = arb(1)
    return Moments(arb(int(i == 0)), vector(*(arb(int(i == k)) for k in (1, 2, 3))), J)


def _links(bodies: Bodies, definition: Plain, numbers: Numbers, joints: range, prefix: str) -> list[_Link]:
    """Of one instance, by carrier; what is fixed to its interface last, where that moves."""
    seat, found = bodies.frames[f"{prefix}base"], dict[int, _Link]()
    fixed = _Link(f"{prefix}base", seat, massless())
    for body in in_order(definition):
        name = f"{prefix}{body['name']}"
        frame = bodies.frames[name]
        link = found.setdefault(frame.carrier, _Link(name, frame, massless())) if frame.carrier in joints else fixed
        link.moments = link.moments + mass_of(body, numbers).outwards(frame.A, frame.p)
        if link is fixed:
            found[seat.carrier] = fixed
    moving = [found[k] for k in sorted(found) if k in joints]
    return [*moving, fixed] if seat.carrier != GROUND and seat.carrier in found else moving


def base_outputs(
    source: Stored,
    own: Stored,
    coordinates: Sequence[str],
    base: Sequence[int],
    drives: Sequence[str],
    values: Mapping[str, Ball],
) -> Outputs:
    """Columns ``base`` of Y, and beta = grouping pi; ``source``: the certified regressor, ``own``: the program of base
    parameters. Raises VerificationFailed where Y is not Y_B times the grouping.
    """
    n, found, here = len(coordinates), operations_in_balls(source, values), operations_in_balls(own, values)
    Y = _elements(source, "regressor", found)
    standard = source.outputs["regressor"].shape[1]
    for k, (kind, a) in enumerate((kind, a) for kind in drives for a in range(n)):
        speed = values[f"{coordinates[a]}'"]
        drive = {"armature": values[f"{coordinates[a]}''"], "viscous": speed, "coulomb": speed.sgn(), "offset": arb(1)}
        Y[a, standard + k] = drive[kind]
    grouping, zero = _elements(own, "grouping", here), arb(0)
    columns = own.outputs["grouping"].shape[1]
    for j in range(columns):
        for a in range(n):
            told = total(Y.get((a, b), zero) * grouping[k, j] for k, b in enumerate(base) if (k, j) in grouping)
            if not told.overlaps(Y.get((a, j), zero)):
                raise VerificationFailed(f"column {j} of the regressor is not what its grouping says")
    pi = _elements(source, "inertial_parameters", found)
    result = Outputs()
    columns_of(result, "base_regressor", n, [[Y.get((a, b), zero) for a in range(n)] for b in base])
    # compared with Y above
    result.array("grouping", (len(base), columns)).update(grouping)
    beta = [total(c * pi.get((j,), zero) for (i, j), c in grouping.items() if i == k) for k in range(len(base))]
    vector_of(result, "base_parameters", beta)
    return result


def _elements(program: Stored, name: str, found: Sequence[Ball]) -> dict[tuple[int, ...], Ball]:
    output = program.outputs[name]
    return {tuple(index): found[entry] for index, entry in zip(output.index, output.entries, strict=True)}
