"""From the joints of bodies to the coordinates that are left where relations move some: x_i = N_ai x_a."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from flint import arb

from substructures.certificate.bodies import Bodies
from substructures.certificate.linear import Ball
from substructures.certificate.outputs import Outputs, Values, images_of

#: axes of outputs that are joints, or coordinates
AXES: dict[str, tuple[int, ...]] = {
    "metric": (0, 1),
    "christoffel": (0, 1, 2),
    "kappa": (0, 1),
    "F": (0, 1),
    "N": (0, 1),
    **dict.fromkeys(("f", "n", "K", "applied", "gravity", "forces", "bias", "nonlinear_effects"), (0,)),
    **dict.fromkeys(("inverse_dynamics", "linear_momentum", "angular_momentum", "regressor"), (0,)),
    **dict.fromkeys(("U", "Omega", "port.U", "port.Omega", "closure.jacobian", "centroidal_momentum_matrix"), (1,)),
    **dict.fromkeys(("limits", "friction", "friction_load"), (0,)),
    "g_a0": (0,),
    "Gamma_a00": (0,),
    "Gamma_ab0": (0, 1),
}


def rates(bodies: Bodies, values: Mapping[str, Ball], mark: str) -> list[Ball]:
    """q'^a or q''^a of all joints; ``values``: of the symbols of the coordinates."""
    return [values[f"{joint.mover}{mark}"] * joint.slope for joint in bodies.joints]


def along(bodies: Bodies) -> list[int]:
    """The joints whose coordinates are left."""
    return [a for a, joint in enumerate(bodies.joints) if joint.coordinate == joint.mover]


def gathered(bodies: Bodies, terms: Mapping[int, Ball]) -> dict[int, Ball]:
    """N_ai Q_a by the joint whose coordinate moves the others."""
    place, result = {bodies.joints[a].coordinate: a for a in along(bodies)}, dict[int, Ball]()
    for a, x in terms.items():
        at = place[bodies.joints[a].mover]
        result[at] = result.get(at, arb(0)) + x * bodies.joints[a].slope
    return result


def of_coordinates(result: Outputs, bodies: Bodies) -> Outputs:
    """The outputs with an index of coordinates where there is one of joints."""
    left = along(bodies)
    if len(left) < len(bodies.joints):
        number = {bodies.joints[a].coordinate: i for i, a in enumerate(left)}
        for name, axes in AXES.items():
            if name in result:
                result[name] = _of_coordinates(name, result[name], bodies, axes, number)
    return result


def _of_coordinates(
    name: str, values: Values, bodies: Bodies, axes: Iterable[int], number: Mapping[str, int]
) -> Values:
    shape = tuple(len(number) if axis in axes else size for axis, size in enumerate(values.shape))
    is_gamma = name == "christoffel"
    found = Values(shape, "connection" if is_gamma else values.symmetry, scale=values.scale)
    for index, x in _all(name, values):
        place, term = list(index), x
        for axis in axes:
            joint = bodies.joints[index[axis]]
            place[axis], term = number[joint.mover], term * joint.slope
        at = tuple(place)
        last_two = at[-2:] if is_gamma else at[:2]
        if (is_gamma or name in ("metric", "kappa", "F", "N")) and last_two != tuple(sorted(last_two)):
            continue
        if name != "kappa" or at[0] != at[1]:
            found.entries[at] = found.entries.get(at, arb(0)) + term
    return found


def _all(name: str, values: Values) -> Iterator[tuple[tuple[int, ...], Ball]]:
    """All elements: those that are not kept follow from d_b u_c = d_c u_b, and from products of two vectors."""
    for index, x in values.entries.items():
        for image, sign in dict(images_of(index, values.symmetry)).items():
            yield image, x * sign
        if name in ("F", "N", "kappa") and index[0] != index[1]:
            b, c, i = index
            yield (c, b, i), -x if name == "kappa" else x
