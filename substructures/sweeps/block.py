"""A range of rows of a sweep: which fit, what they are worth, and why others could not be had."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.errors import InvalidDocument, InvalidInput, MissingValue, TooLarge, VerificationFailed, among
from substructures.part.part import MAX_NODES, Part
from substructures.quantities.numbers.evaluation import interpreted
from substructures.quantities.sources import Sources, of_parts
from substructures.sweeps.document import Pareto
from substructures.sweeps.front import front
from substructures.sweeps.plan import Plan
from substructures.sweeps.shapes import (
    INTERPRETER,
    KERNEL,
    WORTH_A_KERNEL,
    Option,
    Shape,
    couple_shape,
    values_of,
)
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec

Rows = NDArray[np.int64]
#: rows that are evaluated at a time: their intermediate values stay in the cache of a core
AT_ONCE = 8192
#: rows of a front, of which others may beat the first ones, that a part of a sweep has beside those that it is to keep
OF_FRONT = 20_000
#: relative difference from the slow way, times the condition number of the mass matrix
AGREE = 1e-12
#: units of rounding by which numbers are moved to see what terms that cancel leave, and how often
EPS, UNITS, TRIES = float(np.finfo(np.float64).eps), 4, 8


@dataclass
class Refusals:
    """Why rows have no numbers: how many by code, each with the first row and its message; ``ways``: how many rows
    each way of computing gave numbers for.
    """

    by_code: dict[str, dict[str, Any]] = field(default_factory=dict)
    ways: dict[str, int] = field(default_factory=dict)

    def add(self, code: str, count: int, row: int, message: str) -> None:
        """So many rows more."""
        here = self.by_code.setdefault(code, {"rows": 0, "example": {"row": row, "message": message[:500]}})
        here["rows"] += count


@dataclass(frozen=True)
class Block:
    """Rows that fit, by number, with their columns (those of the samples too)."""

    rows: Rows
    columns: Mapping[str, Array]

    def take(self, places: NDArray[Any]) -> Block:
        """Some of them."""
        return Block(self.rows[places], {name: x[places] for name, x in self.columns.items()})


#: the shape of options, made at most once; the option of an instance by the indices of both
ShapeOf = Callable[[Sequence[Option]], Shape]
OptionOf = Callable[[int, int], Option]


def compute(
    plan: Plan, start: int, stop: int, option: OptionOf, shape_of: ShapeOf, refusals: Refusals, finite: list[int]
) -> Block:
    """The rows from ``start`` to ``stop`` that fit; ``finite`` is given how many have numbers."""
    size = plan.sampler.size
    numbers = np.arange(start, stop, dtype=np.int64)
    combination, sample = numbers // size, numbers % size
    samples = _samples(plan, sample, start, stop)
    groups: dict[tuple[str, ...], list[int]] = {}
    options = dict[int, list[Option]]()
    for each in range(int(combination[0]), int(combination[-1]) + 1):
        try:
            chosen = [option(i, k) for i, k in enumerate(plan.chosen(each))]
        except (InvalidInput, TooLarge) as error:
            first = max(start, each * size)
            refusals.add(_code(error), int((combination == each).sum()), first, str(error))
            continue
        options[each] = chosen
        groups.setdefault(tuple(one.key for one in chosen), []).append(each)
    found = []
    for members in groups.values():
        here = np.flatnonzero(np.isin(combination, members)) if len(groups) > 1 else np.arange(len(numbers))
        try:
            many = max(plan.rows_of_shape, 2 * len(here)) >= WORTH_A_KERNEL
            shape = replace(shape_of(options[members[0]]), way=KERNEL if many else INTERPRETER)
            values = _values(plan, shape, [options[each] for each in members])
            place = np.searchsorted(members, combination[here])
            spread = {name: x[place] if np.ndim(x) else x for name, x in values.items()}
            own = {name: x[here] for name, x in samples.items()}
            columns = plan.columns.of(shape, {**spread, **own}, own, len(here))
        except (InvalidInput, MissingValue, TooLarge, VerificationFailed, ArithmeticError) as error:
            refusals.add(_code(error), len(here), int(numbers[here[0]]), str(error))
            continue
        refusals.ways[shape.way] = refusals.ways.get(shape.way, 0) + len(here)
        found.append(_fitting(plan, Block(numbers[here], {**own, **columns}), refusals, finite))
    return joined(plan, found, stop - start, is_whole=False)


def _samples(plan: Plan, sample: Rows, start: int, stop: int) -> dict[str, Array]:
    """The samples of rows, made for their range where that has them one after the other."""
    size = plan.sampler.size
    if not plan.sampler.names:
        return {}
    if sample[0] + (stop - start) <= size:
        return plan.sampler.rows(int(sample[0]), int(sample[0]) + stop - start)
    if size <= stop - start:
        return {name: x[sample] for name, x in plan.sampler.rows(0, size).items()}
    low = plan.sampler.rows(int(sample[0]), size)
    high = plan.sampler.rows(0, int(sample[-1]) + 1)
    return {name: np.concatenate([low[name], high[name]]) for name in low}


def _values(plan: Plan, shape: Shape, options: Sequence[Sequence[Option]]) -> dict[str, Any]:
    """By the parameters of the model: one number, or one for each of the combinations of a shape."""
    sampled, parameters = set(plan.sampler.names), shape.model.parameters
    for name in sampled:
        _require_known(name, parameters)
    numbers = [values_of(some) for some in options]
    values: dict[str, Any] = {}
    for name in parameters:
        if name in sampled or "." not in name:
            continue  # a parameter of the tree itself has its default in the model
        if name in numbers[0]:  # or in none: such options have other shapes
            column = np.array([some[name] for some in numbers])
            values[name] = float(column[0]) if (column == column[0]).all() else column
    return values


def _require_known(name: str, known: Mapping[str, Any]) -> None:
    """Raise InvalidDocument for a parameter that the tree does not have, or that is bound."""
    if name in known:
        return
    message = f"the tree has no parameter '{name[:80]}' that is free{among(name, known)}"
    raise InvalidDocument.at(f"/samples/of/{name}", "unknown-parameter", message)


def _fitting(plan: Plan, block: Block, refusals: Refusals, finite: list[int]) -> Block:
    """Those that have numbers, and that the condition holds for."""
    good = np.ones(len(block.rows), dtype=np.bool_)
    for name in plan.columns.names:
        good &= np.isfinite(block.columns[name])
    bad = np.flatnonzero(~good)
    if len(bad):
        first = int(bad[0])
        names = ", ".join(f"'{name}'" for name in plan.columns.names if not np.isfinite(block.columns[name][first]))
        refusals.add("not-finite", len(bad), int(block.rows[first]), f"no finite number for {names}")
        block = block.take(np.flatnonzero(good))
    finite.append(len(block.rows))
    fits = plan.columns.where.holds(block.columns, len(block.rows))
    return block if fits.all() else block.take(np.flatnonzero(fits))


def joined(plan: Plan, blocks: Iterable[Block], count: int, is_whole: bool = True) -> Block:
    """One block in the order of rows, of those that are to be kept; unless it ``is_whole`` of those that may be. Every
    block is put in its place as it comes, so that none is there twice; ``count``: rows of all together, at most.
    """
    rows, end = np.empty(count, dtype=np.int64), 0
    columns: dict[str, Array] = {}
    for block in blocks:
        start, end = end, end + len(block.rows)
        rows[start:end] = block.rows
        for name, x in block.columns.items():
            whole = columns.get(name)
            if whole is None or not np.can_cast(x.dtype, whole.dtype):
                whole = np.empty(count, x.dtype) if whole is None else whole.astype(np.result_type(whole, x))
                columns[name] = whole
            whole[start:end] = x
    found = Block(rows[:end], {name: x[:end] for name, x in columns.items()})
    if not columns:
        found = Block(rows[:0], {name: np.zeros(0) for name in (*plan.sampler.names, *plan.columns.names)})
    if (found.rows[1:] < found.rows[:-1]).any():
        found = found.take(np.argsort(found.rows, kind="stable"))
    keep = plan.document.keep
    return found if keep is None or end <= keep else found.take(best(found, plan.document.pareto, keep, is_whole))


def objectives(columns: Mapping[str, Array], pareto: Pareto) -> Array:
    """(rows, k), all to be minimised."""
    down, up = ([columns[name] for name in names] for names in (pareto.minimise, pareto.maximise))
    return np.stack([*down, *(-x for x in up)], axis=1)


def best(block: Block, pareto: Pareto | None, keep: int, is_whole: bool) -> Rows:
    """The places of so many rows: the Pareto front, then by its first column; without one the first rows. Of a part of
    a sweep, which other rows may throw off the front, so many beside the front.
    """
    if pareto is None:
        return np.arange(keep, dtype=np.int64)
    values = objectives(block.columns, pareto)
    on_front = np.zeros(len(values), dtype=np.int64)
    on_front[front(values)] = 1
    count = keep if is_whole else keep + min(int(on_front.sum()), OF_FRONT)
    return np.sort(np.lexsort((block.rows, values[:, 0], -on_front))[:count])


def _code(error: Exception) -> str:
    if isinstance(error, InvalidInput):
        return error.faults[0].code
    names = {MissingValue: "missing-value", TooLarge: "too-large", VerificationFailed: "verification-failed"}
    return next((code for kind, code in names.items() if isinstance(error, kind)), "not-finite")


class _Interpreted(Shape):
    """A certified tree, whose numbers come from the reference interpreter."""

    def evaluate(self, *arguments: Any) -> dict[str, Array]:
        """As the engine that needs nothing."""
        return interpreted(*arguments)


def slow_columns(
    plan: Plan, row: int, parts: Sequence[Part], max_nodes: int = MAX_NODES
) -> tuple[dict[str, float], float]:
    """The columns of a row the slow way: its tree as a document with numbers, coupled, certified and interpreted; and
    the largest condition number of its mass matrix at the states of columns. Raises as coupling does.
    """
    spec = TreeSpec.read(plan.tree(row))
    by_name = {instance.name: part for instance, part in zip(spec.instances, parts, strict=True)}
    shape = _Interpreted(Sources(couple(spec, by_name, max_nodes), of_parts=of_parts(spec, by_name, max_nodes)))
    sample = row % plan.sampler.size
    samples = plan.sampler.rows(sample, sample + 1)
    found = plan.columns.of(shape, {}, samples, 1)
    return {name: float(x[0]) for name, x in found.items()}, plan.columns.condition(shape)


def rounding(plan: Plan, row: int, options: Sequence[Option], shape_of: ShapeOf) -> dict[str, float]:
    """How far the columns of a row move where its numbers do by some units of rounding, at random."""
    sample, draw = row % plan.sampler.size, np.random.default_rng(row)
    shape = replace(shape_of(options), way=INTERPRETER)
    samples = {name: x[0] for name, x in plan.sampler.rows(sample, sample + 1).items()}
    numbers = {**_values(plan, shape, [options]), **samples}
    moved = {name: x * (1 + EPS * draw.integers(-UNITS, UNITS + 1, TRIES)) for name, x in numbers.items()}
    found = plan.columns.of(shape, moved, {name: moved[name] for name in samples}, TRIES)
    return {name: float(np.ptp(x)) for name, x in found.items()}


def disagreement(
    fast: Mapping[str, float],
    slow: Mapping[str, float],
    condition: float,
    without: Collection[str] = (),
    moved: Callable[[], Mapping[str, float]] = dict,
) -> str:
    """What to say where a row differs from the slow way by more than rounding can; empty where it does not.

    ``without``: columns of motions, which are judged by their own conditions; ``moved``: :func:`rounding`, which is
    asked for where terms may cancel.
    """
    for name, x in fast.items():
        if name in without:
            continue
        y = slow[name]
        apart = abs(x - y) > AGREE * max(1.0, condition) * max(abs(x), abs(y))
        if apart and not abs(x - y) <= AGREE / (UNITS * EPS) * moved().get(name, 0.0):
            return f"'{name}' is {x!r}, and {y!r} by the tree of this row"
    return ""


def shape_maker(plan: Plan, made: dict[tuple[str, ...], Shape], max_nodes: int = MAX_NODES) -> ShapeOf:
    """What couples each shape once; ``made``: those there are."""

    def shape_of(options: Sequence[Option]) -> Shape:
        """The shape. Raises InvalidInput, TooLarge."""
        key = tuple(option.key for option in options)
        if key not in made:
            document, columns = plan.document.template, plan.columns
            made[key] = couple_shape(document, options, columns.need_christoffel, max_nodes, columns.outputs)
        return made[key]

    return shape_of
