"""A tree whose base floats: metric and Christoffel symbols in rates that no attitude makes singular.

The rates are v = (v_x, v_y, v_z, w_x, w_y, w_z, q'^1, ..., q'^n): velocity of the base's origin and angular velocity of
the base, both in axes fixed in the base, which the frame of the world is here, then those of the joints. With

    g~_ab v'^b + Gamma~_abc v^b v^c = Q_a        R' = R [w]x,  p' = R v  for the attitude R and the place p of the base

neither depends on where the base is. Gamma~_abc = Gamma~_acb; they are not those of the metric g~ alone, since the
rates are not derivatives of coordinates (Boltzmann and Hamel). Gravity g_0 in the axes of the base gives Q_a = g~_ai
g_0^i, i = 1, 2, 3; a force F at the base's origin and a moment M are Q = (F, M, 0).

They are those of the tree on a host without mass that floats (:mod:`substructures.mechanics.balls`).

Source: J. G. Papastavridis, Analytical Mechanics, 2002, chapter 3; the formalism of the paper for the tree on its host.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial

from substructures.certificate.derived.floating import (
    METRIC,
    SYMBOLS,
    floating_christoffel_outputs,
    floating_metric_outputs,
)
from substructures.errors import TooLarge
from substructures.expr.program import Formulas, program
from substructures.expr.replay import replay
from substructures.mechanics.formula_size import MOST_CHRISTOFFEL, entries_of
from substructures.part.derive import derive
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.quantities.of_parts import formed
from substructures.quantities.part_models import OfParts
from substructures.tree.assembly import Assembly, joint_parents, unchecked
from substructures.tree.coupling import couple_parts
from substructures.tree.document import Instance, TreeSpec, require_ungiven
from substructures.tree.given.driven import all_coordinates, put_in
from substructures.tree.given.ties import require_chains
from substructures.tree.model_outputs import model_outputs

#: the rates of the base
BASE = ("vx", "vy", "vz", "wx", "wy", "wz")
_HOST, _PLATFORM = "base", "platform"


class FloatingTree(OfParts):
    """``program``: the output ``floating_metric`` (6 + n, 6 + n), or ``floating_christoffel`` (6 + n, 6 + n, 6 + n),
    functions of q and the parameters; ``rows``: the rates.
    """

    axis = "rates"


def floating_metric(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> FloatingTree:
    """g~ of a tree of stored parts (by instance name). Raises as :func:`.of_parts.formed`."""
    make = partial(_outputs, spec, parts, False)
    return FloatingTree(*formed("floating metric", spec, parts, make, floating_metric_outputs, max_nodes))


def floating_christoffel(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> FloatingTree:
    """Gamma~, symmetric in its last two indices. Raises as :func:`.of_parts.formed`."""
    make = partial(_outputs, spec, parts, True)
    return FloatingTree(
        *formed("floating Christoffel symbols", spec, parts, make, floating_christoffel_outputs, max_nodes)
    )


def _outputs(
    spec: TreeSpec, parts: Mapping[str, Part], christoffel: bool, assembly: Assembly
) -> tuple[dict[str, Formulas], tuple[str, ...]]:
    require_ungiven(spec, "give what moves as a part of its own")
    require_chains(assembly.balls, "ask for 'metric' and 'christoffel'")
    host = _free_name(spec)
    # closures say nothing of these
    hosted = unchecked(_hosted(spec, host), {**parts, host: _host_part()})
    entries = entries_of(joint_parents(hosted.mounted))
    if christoffel and entries.is_large:
        raise TooLarge("the floating Christoffel symbols (in elements)", entries.christoffel, MOST_CHRISTOFFEL)
    graph = hosted.scope.graph
    coupled = couple_parts(over_formulas(graph), hosted.mounted, hosted.gravity, christoffel)
    quantity, name = ("christoffel", SYMBOLS) if christoffel else ("metric", METRIC)
    found = put_in(hosted, model_outputs(hosted, coupled, [], [], frozenset({"metric", quantity})))
    moved = program(graph, {name: found[quantity]}, hosted.scope.symbols)
    own = [f"{coordinate}'" for coordinate in all_coordinates(assembly)]
    return replay(moved, assembly.scope.graph, {}), (*BASE, *own)


def _free_name(spec: TreeSpec) -> str:
    """A name that no instance and no parameter has."""
    taken, name = {*spec.parameters, *(each.name for each in spec.instances)}, _HOST
    while name in taken:
        name += "_"
    return name


@lru_cache(maxsize=1)
def _host_part() -> Part:
    joint = {"type": "floating", "velocities": list(BASE)}
    return derive({"name": _HOST, "bodies": [{"name": _PLATFORM, "parent": "base", "joint": joint}]})


def _hosted(spec: TreeSpec, host: str) -> TreeSpec:
    """The tree on its host, without what has no mass."""
    place = f"{host}.{_PLATFORM}"
    seated = [each.model_copy(update={"at": place}) if each.at == "world" else each for each in spec.instances]
    instances = (Instance(name=host, substructure=_HOST), *seated)
    return spec.model_copy(update={"instances": instances, "loads": (), "closures": (), "inputs": {}})
