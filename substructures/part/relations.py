"""Relations between the coordinates of joints: those that the equations have, and those that a definition leaves out.

A joint whose coordinate is related to another has none of its own, q^d = mu q^i + delta: the formulas of all joints
become those of the coordinates that are left by :class:`substructures.mechanics.ratios.Ratios`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from substructures.errors import among
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program
from substructures.expr.units.unit_check import Notice
from substructures.loads.scope import Scope, no_names
from substructures.mechanics.balls import BILINEAR, BallJoint, in_rates
from substructures.mechanics.ratios import Ratios
from substructures.part.definition import Definition, Relation

#: by output, its axes that are coordinates, of parts and of trees
OF_COORDINATES: dict[str, tuple[int, ...]] = {
    "metric": (0, 1),
    "christoffel": (0, 1, 2),
    **dict.fromkeys(("kappa", "F", "N"), (0, 1)),
    **dict.fromkeys(("f", "n", "K", "applied"), (0,)),
    **dict.fromkeys(("U", "Omega", "port.U", "port.Omega", "closure.jacobian"), (1,)),
    **dict.fromkeys(("gravity", "forces", "bias", "nonlinear_effects", "inverse_dynamics", "regressor"), (0,)),
    **dict.fromkeys(("linear_momentum", "angular_momentum", "limits", "friction", "friction_load"), (0,)),
}
#: stored where joints are related: by joint, mu and delta with the coordinate that moves it
MULTIPLIER, OFFSET = "multiplier", "offset"

_WEIGHTLESS = "no mass, moment of inertia or armature moves with '{}': forces do not determine its acceleration"


def require_relations(definition: Definition, coordinates: Sequence[str]) -> None:
    """Raise InvalidDocument for relations between coordinates that are not there, or with factors that vary."""
    scope = Scope(Graph())
    for i, each in enumerate(definition.left_out):
        if each.relation is None:
            continue
        for field in ("coordinate", "of"):
            name, pointer = getattr(each.relation, field), f"/left_out/{i}/relation/{field}"
            if name not in coordinates:
                scope.fault(pointer, "unknown-coordinate", f"there is no coordinate '{name}'{among(name, coordinates)}")
        for field in ("multiplier", "offset"):
            scope.read(getattr(each.relation, field), f"/left_out/{i}/relation/{field}", no_names)
    scope.finish()


def left_out_warnings(definition: Definition) -> list[Notice]:
    """A warning for each remark; pointers lead into the definition."""
    return [
        {"pointer": f"/left_out/{i}", "code": "left-out", "message": each.message}
        for i, each in enumerate(definition.left_out)
    ]


def weightless_warnings(program: Program, coordinates: Sequence[str]) -> list[Notice]:
    """A warning for each coordinate a with g_aa = 0 in all positions, where the metric is stored."""
    metric = program.outputs.get("metric")
    stored = None if metric is None else set(metric.index)
    return [
        {"pointer": "", "code": "weightless", "message": _WEIGHTLESS.format(name)}
        for a, name in enumerate(coordinates)
        if stored is not None and (a, a) not in stored
    ]


def read_relations(
    relations: Sequence[Relation], before: Sequence[int], names: Sequence[str], scope: Scope
) -> list[tuple[int, Expr, Expr]]:
    """By joint the one whose coordinate moves it, mu and delta.

    ``before``: by joint the one that it depends on, or itself; ``names``: of their coordinates.
    """
    graph, given = scope.graph, {each.coordinate: (i, each) for i, each in enumerate(relations)}
    own = {
        a: tuple(
            scope.read(getattr(given[name][1], x), f"/relations/{given[name][0]}/{x}") for x in (MULTIPLIER, OFFSET)
        )
        for a, name in enumerate(names)
        if before[a] != a
    }
    result: list[tuple[int, Expr, Expr]] = []
    for joint in range(len(names)):
        # q^c = mu_c (mu_b q^a + delta_b) + delta_c
        a, mu, delta = joint, graph.one, graph.zero
        while before[a] != a:
            factor, offset = own[a]
            a, mu, delta = before[a], mu * factor, mu * offset + delta
        result.append((a, mu, delta))
    return result


def of_coordinates(outputs: Mapping[str, Formulas], ratios: Ratios) -> dict[str, Formulas]:
    """The outputs with coordinates in place of joints along the axes that are OF_COORDINATES."""
    if ratios.is_identity:
        return dict(outputs)
    return {name: _reduced(name, each, ratios) if name in OF_COORDINATES else each for name, each in outputs.items()}


def of_rates(
    outputs: Mapping[str, Formulas], balls: Sequence[BallJoint], rotor: Callable[[int], Any]
) -> dict[str, Formulas]:
    """The outputs of joints with those that rates multiply twice in the rates of ball joints: christoffel, F, N.

    ``rotor``: the armature a of a joint; it takes a v', not a q''.
    """
    result = dict(outputs)
    for name, (linear, place) in BILINEAR.items():
        if balls and name in outputs:
            each = outputs[name]
            # one of (b, c) and (c, b), in which it stays symmetric; Gamma_abc = -Gamma_cba is lost (Boltzmann, Hamel)
            entries: dict[tuple[int, ...], Any] = {i: x for i, x in each.expanded().items() if i[place] <= i[place + 1]}
            linears = outputs[linear].expanded()
            for k in (k for ball in balls for k in ball.joints if name == "christoffel"):
                linears[k, k] = linears[k, k] - rotor(k)
            halves = {index: _half(x) for index, x in linears.items()}
            # Gamma~_abc = Gamma_abc + 1/2 c_ibc g_ai, F_bc and N_bc with f_i and n_i (section 14)
            for at, term in in_rates(balls, halves, place).items():
                entries[at] = entries[at] + term if at in entries else term
            result[name] = Formulas(each.shape, entries, "connection" if name == "christoffel" else each.symmetry)
    return result


def _half(x: Any) -> Any:
    """Exactly of a formula."""
    return x * (Fraction(1, 2) if isinstance(x, Expr | int) else 0.5)


def _reduced(name: str, each: Formulas, ratios: Ratios) -> Formulas:
    axes, n = OF_COORDINATES[name], ratios.count
    shape = tuple(n if axis in axes else size for axis, size in enumerate(each.shape))
    whole: dict[tuple[int, ...], Any] = {**each.expanded(), **_others(name, each)}
    # of x_ab and x_ba both, also where one of them is stored alone: N_ai N_bj x_ab mixes them
    found = ratios.reduced(whole, axes)
    if name == "christoffel":
        # Gamma_cba = -Gamma_abc holds for joints alone
        return Formulas(shape, {i: x for i, x in found.items() if i[1] <= i[2]}, "connection")
    if len(axes) == 2:
        # kappa*_ii = 0, as N^T kappa N is skew like kappa
        last = 1 if name == "kappa" else 0
        found = {i: x for i, x in found.items() if i[0] + last <= i[1]}
    return Formulas(shape, found, each.symmetry)


def _others(name: str, each: Formulas) -> Mapping[tuple[int, ...], Any]:
    """F_cb = F_bc, N_cb = N_bc and kappa_ca = -kappa_ac, which are not stored."""
    sign = {"F": 1, "N": 1, "kappa": -1}.get(name)
    if sign is None:
        return {}
    return {(c, b, i): x if sign > 0 else -x for (b, c, i), x in each.entries.items() if b != c}
