"""Outputs along the coordinates that do not depend on others, from those of all coordinates (:mod:`.loops`).

    x*_i = N_ai x_a     bias*_i = N_ai (bias_a + g_ab k_b)     Gamma*_ijk = N_ai (Gamma_abc N_bj N_ck + g_ab H_bjk)

and of those what given motions make, by the same sums as of trees without loops.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from flint import arb

from substructures.certificate.by_coordinate import AXES
from substructures.certificate.closures import ROWS
from substructures.certificate.described import (
    coordinates_in,
    free_coordinates,
    hosts_first,
    is_dependent,
    positions_in,
)
from substructures.certificate.given.closing import PRIMES, Build
from substructures.certificate.given.ignored import MOTIONS, OWN, along, contracted, whole
from substructures.certificate.given.loops import Loops, Reduced
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Bindings, Plain
from substructures.certificate.outputs import Outputs, Values

Index = tuple[int, ...]
#: the Christoffel symbols of metrics, and how many rates there are before those of coordinates
SYMBOLS = {"metric": ("christoffel", 0), "floating_metric": ("floating_christoffel", 6)}
BEFORE = {name: first for metric, (symbols, first) in SYMBOLS.items() for name in (metric, symbols) if first}
#: what has a term more where accelerations are those of the loop
BENT = {"bias": "metric", "nonlinear_effects": "metric"}


def reduced_symbols(tree: Plain, definitions: Mapping[str, Plain], kinds: Mapping[str, str]) -> dict[str, str]:
    """The kinds of symbols without those of dependent coordinates."""
    every = coordinates_in(tree, definitions)
    names = [name for name in every if is_dependent(tree, definitions, name)]
    gone = {f"{name}{p}" for name in names for p in PRIMES}
    return {name: kind for name, kind in kinds.items() if name not in gone}


def reduced_at(tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball], build: Build) -> Reduced:
    """The dependent coordinates of a tree at ``values`` of all other symbols, on the sides ``tree["sides"]`` of all
    closures, by default those of the start, or at what this says in words; not finite where a loop is open.
    """
    bound = {f"{i['name']}.{p}": x for i in tree.get("instances", ()) for p, x in i.get("parameters", {}).items()}
    names, found = Bindings(values, bound), Reduced(dict(values), {}, {}, {})
    given = tree.get("sides", ())
    sides = given if isinstance(given, str) else iter(given)
    for name in tree.get("reduced", ()):
        own = {f"{name}.{p}": names[f"{name}.{p}"] for p in definitions[name].get("parameters", ())}
        Loops(name, definitions[name], {**values, **own}, build).solve(found, sides)
    return found


def all_free(tree: Plain) -> Plain:
    """The tree with all coordinates of its parts, none of which is given."""
    return {name: x for name, x in tree.items() if name not in ("reduced", "driven", "ignored")}


def reduced_outputs(tree: Plain, definitions: Mapping[str, Plain], found: Reduced, outputs: Outputs) -> Outputs:
    """What outputs of all coordinates are along those that do not depend on others, closures of the tree alone."""
    if not tree.get("reduced"):
        return outputs
    names = list(coordinates_in(tree, definitions))
    free = list(free_coordinates(tree, definitions))
    number = {name: a for a, name in enumerate(names)}
    pushed = [{number[q]: x for q, x in found.N.get(y, {y: arb(1)}).items()} for y in free]
    pull = {number[q]: x for q, x in found.pull.items()}
    result = Outputs()
    opened = _open(tree, definitions, outputs)
    for name, values in opened.items():
        linear = BENT.get(name) or ("closure.jacobian" if name == "closure.acceleration" else None)
        more = _pulled(opened[linear] if linear else None, pull)
        first = BEFORE.get(name, 0)
        left = [*range(first), *(first + number[y] for y in free)]
        result[name] = _along_free(name, values, (_behind(first, pushed), left), more)
    if "position_rates" in result:
        left = [i for i, q in enumerate(positions_in(tree, definitions)) if not is_dependent(tree, definitions, q)]
        rates = result["position_rates"].entries
        result["position_rates"] = Values((len(left),), entries={(k,): rates[i,] for k, i in enumerate(left)})
    for metric, (symbols, first) in SYMBOLS.items():
        if symbols in result:
            half = contracted(whole(outputs[metric]), 0, _behind(first, pushed))
            bends = {first + a: found.H.get(name, {}) for a, name in enumerate(names)}
            _bend(result[symbols].entries, half, bends, {y: first + i for i, y in enumerate(free)})
            if first:
                # which is there for these alone
                del result[metric]
    return result


def _bend(
    entries: dict[Index, Ball],
    half: Mapping[Index, Ball],
    bends: Mapping[int, Mapping[tuple[str, str], Ball]],
    place: Mapping[str, int],
) -> None:
    """Gamma with N_ai g_ab H_bjk more."""
    for (i, b), x in half.items():
        for pair, bend in bends.get(b, {}).items():
            j, k = sorted(place[y] for y in pair)
            entries[i, j, k] = entries.get((i, j, k), arb(0)) + x * bend


def _behind(first: int, pushed: Sequence[dict[int, Ball]]) -> list[dict[int, Ball]]:
    """The columns of N behind those of a base."""
    base = ({i: arb(1)} for i in range(first))
    return [*base, *({first + a: x for a, x in column.items()} for column in pushed)]


def _pulled(linear: Values | None, pull: Mapping[int, Ball]) -> dict[Index, Ball]:
    """x_ab k^b."""
    result: dict[Index, Ball] = {}
    for (a, b), x in ({} if linear is None else whole(linear)).items():
        if b in pull:
            result[a,] = result.get((a,), arb(0)) + x * pull[b]
    return result


def _open(tree: Plain, definitions: Mapping[str, Plain], outputs: Outputs) -> Outputs:
    """Without the closures of reduced parts."""
    kept, first = list[int](), 0
    closures = [("", each) for each in tree.get("closures", ())]
    closures += [(i["name"], each) for i in hosts_first(tree) for each in definitions[i["name"]].get("closures", ())]
    for name, closure in closures:
        count = len(ROWS[closure["type"]])
        kept += range(first, first + count) if name not in tree["reduced"] else ()
        first += count
    place, result = {k: i for i, k in enumerate(kept)}, Outputs(outputs)
    for name in [name for name in outputs if name.startswith("closure.")]:
        values = result.pop(name)
        if kept:
            entries = {(place[k], *rest): x for (k, *rest), x in values.entries.items() if k in place}
            result[name] = replace(values, shape=(len(kept), *values.shape[1:]), entries=entries)
    return result


def _along_free(
    name: str, values: Values, level: tuple[list[dict[int, Ball]], list[int]], more: Mapping[Index, Ball]
) -> Values:
    """An output along the coordinates that do not depend on others."""
    (pushed, free), axes = level, AXES.get(name, tuple(range(len(values.shape))) if name in BEFORE else ())
    if values.along:
        # of what was found by integration its value at the start is not known
        return Values((), entries={(): arb("nan")})
    entries = whole(values)
    for index, x in more.items():
        entries[index] = entries.get(index, arb(0)) + x
    if not axes:
        return replace(values, entries=entries)
    shape = tuple(len(free) if axis in axes else size for axis, size in enumerate(values.shape))
    place = {a: i for i, a in enumerate(free)}
    if name in OWN:
        return replace(values, shape=shape, entries={(place[a], *r): x for (a, *r), x in entries.items() if a in place})
    for axis in axes:
        entries = contracted(entries, axis, pushed)
    if len(axes) > 1:
        entries = {i: x for i, x in entries.items() if i[-2] <= i[-1]}
    symmetry = "connection" if name == "christoffel" else values.symmetry
    return replace(values, shape=shape, symmetry=symmetry, entries=entries, others={})


def driven_level(
    outputs: Outputs, names: Sequence[str], values: Mapping[str, Ball], driven: Collection[str]
) -> Outputs:
    """What given motions make of outputs along ``names``, driven ones among them (:mod:`.driven`)."""
    moving = [a for a, name in enumerate(names) if name in driven]
    every, second = ([values[f"{name}{p}"] for name in names] for p in ("'", "''"))
    v, s = ({a: some[a] for a in moving} for some in (every, second))
    w = {a: x for a, x in enumerate(every) if a not in v}
    g, found, n = whole(outputs["metric"]), Outputs(), len(names)
    linear, pull = along(g, 1, v), along(g, 1, s)
    last = along(linear, 0, v).get((), arb(0))
    found.scalar("g_00", last)
    found.array("g_a0", (n,)).update(linear)
    free = along(along(g, 1, w), 0, w).get((), arb(0))
    for name, x in (("T_2", free / 2), ("T_1", along(linear, 0, w).get((), arb(0))), ("T_0", last / 2)):
        found.scalar(name, x)
    if "christoffel" in outputs:
        mixed = along(whole(outputs["christoffel"]), 2, v)
        found.array("Gamma_ab0", (n, n)).update(mixed)
        found.array("Gamma_a00", (n,)).update(_added(along(mixed, 1, v), pull))
    for name in BENT:
        found[name] = replace(outputs[name], entries=_added(outputs[name].entries, pull))
    for name, axis in MOTIONS.items():
        shape = outputs[name].shape
        found.array(f"{name}_0", shape[:axis] + shape[axis + 1 :]).update(along(whole(outputs[name]), axis, v))
    forces = outputs["inverse_dynamics"].entries
    found.array("drive_forces", (len(moving),)).update({(k,): forces[a,] for k, a in enumerate(moving)})
    found.array("drive_powers", (len(moving),)).update({(k,): forces[a,] * v[a] for k, a in enumerate(moving)})
    if "closure.jacobian" in outputs:
        _driven_closures(found, outputs, (v, s), moving)
    return found


def _driven_closures(
    found: Outputs, outputs: Outputs, motions: tuple[Mapping[int, Ball], Mapping[int, Ball]], moving: Sequence[int]
) -> None:
    """phi_t, c with G_km s''^m, and G_km, of the closures of the tree."""
    G, c = whole(outputs["closure.jacobian"]), outputs["closure.acceleration"]
    m = outputs["closure.jacobian"].shape[0]
    found.array("closure.rate", (m,)).update(along(G, 1, motions[0]))
    found["closure.acceleration"] = replace(c, entries=_added(c.entries, along(G, 1, motions[1])))
    drives: dict[Index, Ball] = {(k, moving.index(a)): x for (k, a), x in G.items() if a in moving}
    found.array("closure.drives", (m, len(moving))).update(drives)


def _added(some: Mapping[Index, Ball], others: Mapping[Index, Ball]) -> dict[Index, Ball]:
    return {i: some.get(i, arb(0)) + others.get(i, arb(0)) for i in {**some, **others}}
