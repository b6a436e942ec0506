"""Ignored coordinates: the outputs of all coordinates at the velocities that given momenta make, and Routh's equations.

The velocities of ignored coordinates are solved from the momenta at the state, g_cc q'^c + g_ca q'^a = p_c; with them,
every output of all coordinates comes from the documents as it does without `ignored`, and is contracted. That the
coordinates are cyclic is seen where they have other values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from flint import arb, arb_mat, fmpq

from substructures.certificate.by_coordinate import AXES
from substructures.certificate.derived.model_at import dot, solve, total
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Bindings, Numbers, Plain
from substructures.certificate.outputs import Outputs, Values, images_of
from substructures.errors import VerificationFailed

Index = tuple[int, ...]
Column = Mapping[int, Ball]
PRIMES = ("", "'", "''")
#: what has to be the same wherever ignored coordinates are
SAME = ("metric", "christoffel", "bias", "forces", "potential_energy")
MOTIONS = {"linear_momentum": 0, "angular_momentum": 0, "U": 1, "Omega": 1}
#: of single joints
OWN = ("limits", "friction", "friction_load")


def ignored_symbols(tree: Plain, kinds: Mapping[str, str]) -> dict[str, str]:
    """The kinds of symbols without those of ignored coordinates."""
    gone = _symbols(tree.get("ignored", ()))
    return {name: kind for name, kind in kinds.items() if name not in gone}


def _symbols(names: Iterable[str]) -> set[str]:
    """Of coordinates, their derivatives and actuators."""
    return {f"{x}{name}{p}" for name in names for x, p in (("tau.", ""), *(("", p) for p in PRIMES))}


def ignored_outputs(
    tree: Plain,
    coordinates: Sequence[str],
    values: Mapping[str, Ball],
    outputs: Callable[[Mapping[str, Ball]], Outputs],
) -> Outputs:
    """The outputs of the coordinates that are left; ``outputs``: those of all ``coordinates`` at values of all symbols.

    Raises VerificationFailed for a coordinate that is not cyclic.
    """
    m = _moving(tree, coordinates, values, outputs)
    cyclic, rest, pushed, (g, w, p) = m.cyclic, m.rest, m.pushed, m.momenta
    rates = [values[f"{coordinates[a]}'"] for a in rest]
    found = outputs(m.values)
    away = outputs({**m.values, **{coordinates[c]: arb(fmpq(2 * k + 1, 3)) for k, c in enumerate(cyclic)}})
    _require_cyclic(found, away, cyclic, coordinates)
    result = Outputs({name: _reduced(name, each, pushed, rest) for name, each in found.items()})
    for name, axis in MOTIONS.items():
        shape = found[name].shape
        result.array(f"{name}_0", shape[:axis] + shape[axis + 1 :]).update(along(whole(found[name]), axis, w))
    _routhian(result, found, (g, w, p), pushed, rates)
    speeds = (m.values[f"{coordinates[c]}'"] for c in cyclic)
    result.array("ignored_rates", (len(cyclic),)).update({(k,): v for k, v in enumerate(speeds)})
    return result


def with_ignored(
    tree: Plain,
    coordinates: Sequence[str],
    values: Mapping[str, Ball],
    outputs: Callable[[Mapping[str, Ball]], Outputs],
) -> dict[str, Ball]:
    """The values of all symbols, those of ignored coordinates among them: 0, their velocities, and the accelerations at
    which momenta stay as they are, g_cc q''^c + g_ca q''^a + Gamma_cij q'^i q'^j = 0. ``values``: of what is left.
    """
    m = _moving(tree, coordinates, values, outputs)
    g, found = m.momenta[0], outputs(m.values)
    _require_cyclic(found, found, m.cyclic, coordinates)
    bias = found["bias"].entries
    second = {a: values[f"{coordinates[a]}''"] for a in m.rest}
    pull = [
        -total([bias.get((c,), arb(0)), *(g[c, a] * x for a, x in second.items() if (c, a) in g)]) for c in m.cyclic
    ]
    accelerations = zip(m.cyclic, solve(_block(g, m.cyclic), pull), strict=True)
    return {**m.values, **{f"{coordinates[c]}''": x for c, x in accelerations}}


class _Moving(NamedTuple):
    """The coordinates that are ignored and those that are left, the columns of P, (g, w, p), and the values of all
    symbols, with the velocities of the ignored ones.
    """

    cyclic: Sequence[int]
    rest: Sequence[int]
    pushed: Sequence[Column]
    momenta: tuple[Mapping[Index, Ball], Column, Sequence[Ball]]
    values: dict[str, Ball]


def _moving(
    tree: Plain,
    coordinates: Sequence[str],
    values: Mapping[str, Ball],
    outputs: Callable[[Mapping[str, Ball]], Outputs],
) -> _Moving:
    given = tree["ignored"]
    cyclic = [a for a, name in enumerate(coordinates) if name in given]
    rest = [a for a in range(len(coordinates)) if a not in cyclic]
    names = [coordinates[c] for c in cyclic]
    still = {**values, **dict.fromkeys(_symbols(names), arb(0))}
    bound = {f"{i['name']}.{p}": x for i in tree.get("instances", ()) for p, x in i.get("parameters", {}).items()}
    numbers = Numbers(Bindings(values, bound))
    p, g = [numbers.read(given[name]) for name in names], whole(outputs(still)["metric"])
    w, pushed = _velocities(g, cyclic, rest, p)
    rates = [values[f"{coordinates[a]}'"] for a in rest]
    speeds = [w[c] + total(column[c] * v for column, v in zip(pushed, rates, strict=True)) for c in cyclic]
    moving = {**still, **{f"{name}'": v for name, v in zip(names, speeds, strict=True)}}
    return _Moving(cyclic, rest, pushed, (g, w, p), moving)


def _block(g: Mapping[Index, Ball], cyclic: Sequence[int]) -> arb_mat:
    """g_cc."""
    return arb_mat(len(cyclic), len(cyclic), [g.get((b, c), arb(0)) for b in cyclic for c in cyclic])


def _velocities(
    g: Mapping[Index, Ball], cyclic: Sequence[int], rest: Sequence[int], p: Sequence[Ball]
) -> tuple[Column, list[Column]]:
    """w, and the columns of P."""
    zero, block = arb(0), _block(g, cyclic)
    columns = (solve(block, [-g.get((c, a), zero) for c in cyclic]) for a in rest)
    pushed: list[Column] = [
        {a: arb(1), **dict(zip(cyclic, column, strict=True))} for a, column in zip(rest, columns, strict=True)
    ]
    return dict(zip(cyclic, solve(block, p), strict=True)), pushed


def _routhian(
    result: Outputs,
    found: Outputs,
    momenta: tuple[Mapping[Index, Ball], Column, Sequence[Ball]],
    pushed: Sequence[Column],
    rates: Sequence[Ball],
) -> None:
    """R + V = T - p_c q'^c by powers of the rates, from T of all coordinates; and what follows from Gamma of all."""
    g, w, p = momenta
    free = _sum_of(pushed, rates)
    # T at q' = P q'_a + w, less p_c q'^c
    linear = [_form(g, column, w) - dot(p, [column[c] for c in w]) for column in pushed]
    last = _form(g, w, w) / 2 - dot(p, list(w.values()))
    result.array("g_a0", (len(pushed),)).update({(a,): x for a, x in enumerate(linear)})
    result.scalar("g_00", 2 * last)
    for name, x in (("T_2", _form(g, free, free) / 2), ("T_1", dot(linear, rates)), ("T_0", last)):
        result.scalar(name, x)
    if "christoffel" in found:
        gamma = along(whole(found["christoffel"]), 2, w)
        result.array("Gamma_ab0", (len(pushed),) * 2).update(contracted(contracted(gamma, 0, pushed), 1, pushed))
        result.array("Gamma_a00", (len(pushed),)).update(contracted(along(gamma, 1, w), 0, pushed))


def _require_cyclic(here: Outputs, away: Outputs, cyclic: Sequence[int], coordinates: Sequence[str]) -> None:
    names = ", ".join(coordinates[c] for c in cyclic)
    for c in cyclic:
        force = here["forces"].entries.get((c,), arb(0))
        if force.is_finite() and not force.contains(0):
            raise VerificationFailed(f"a force acts on {coordinates[c]}, which is ignored")
    for name in SAME:
        if name in here:
            some, others = here[name].entries, away[name].entries
            pairs = ((some.get(i, arb(0)), others.get(i, arb(0))) for i in {*some, *others})
            if any(x.is_finite() and y.is_finite() and not x.overlaps(y) for x, y in pairs):
                raise VerificationFailed(f"{name} depends on {names}, which is ignored")


def whole(values: Values) -> dict[Index, Ball]:
    """All elements."""
    return {image: x * sign for i, x in values.entries.items() for image, sign in images_of(i, values.symmetry)}


def _reduced(name: str, values: Values, pushed: Sequence[Column], rest: Sequence[int]) -> Values:
    """An output along the coordinates that are left."""
    axes, place = AXES.get(name, ()), {a: i for i, a in enumerate(rest)}
    if values.along and not rest:
        # no gradient is left
        return Values((), entries={(): arb("nan")})
    if values.along:
        # a gradient by all coordinates, and a value behind it
        axes, place = (0,), {**place, len(values.along): len(rest)}
    elif not axes:
        return values
    shape = tuple(len(place) if axis in axes else size for axis, size in enumerate(values.shape))
    if values.along or name in OWN:
        left = tuple(values.along[a] for a in rest) if values.along else ()
        return replace(_chosen(values, place), shape=shape, along=left)
    entries = whole(values)
    for axis in axes:
        entries = contracted(entries, axis, pushed)
    symmetry = "connection" if name == "christoffel" else values.symmetry
    if len(axes) > 1:
        entries = {i: x for i, x in entries.items() if i[-2] <= i[-1]}
    return replace(_chosen(values, place), shape=shape, symmetry=symmetry, entries=entries)


def _chosen(values: Values, place: Mapping[int, int]) -> Values:
    """The elements of the coordinates that have a place."""
    entries, others = (
        {(place[i[0]], *i[1:]): x for i, x in some.items() if i and i[0] in place}
        for some in (values.entries, values.others)
    )
    return replace(values, entries=entries, others=others)


def contracted(entries: Mapping[Index, Ball], axis: int, pushed: Sequence[Column]) -> dict[Index, Ball]:
    """P_ia x_..i.."""
    result: dict[Index, Ball] = {}
    for a, column in enumerate(pushed):
        for index, x in along(entries, axis, column).items():
            result[(*index[:axis], a, *index[axis:])] = x
    return result


def along(entries: Mapping[Index, Ball], axis: int, column: Column) -> dict[Index, Ball]:
    """x_..i.. v^i."""
    result: dict[Index, Ball] = {}
    for index, x in entries.items():
        if index[axis] in column:
            at = index[:axis] + index[axis + 1 :]
            result[at] = result.get(at, arb(0)) + x * column[index[axis]]
    return result


def _sum_of(pushed: Sequence[Column], rates: Sequence[Ball]) -> Column:
    """P_ia q'^a."""
    result: dict[int, Ball] = {}
    for column, v in zip(pushed, rates, strict=True):
        for i, x in column.items():
            result[i] = result.get(i, arb(0)) + x * v
    return result


def _form(g: Mapping[Index, Ball], x: Column, y: Column) -> Ball:
    """g_ij x^i y^j."""
    return total(value * x[i] * y[j] for (i, j), value in g.items() if i in x and j in y)
