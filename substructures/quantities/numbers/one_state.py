"""Numbers for one state after the other, as controllers and tools ask for them, with the least work for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import isfinite, prod
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.certificate.agreement import not_judged_warnings
from substructures.compile.kernel import Kernel
from substructures.errors import MissingValue
from substructures.expr.program import Program
from substructures.quantities.numbers.defaults import default_numbers, input_defaults
from substructures.quantities.numbers.levels import dependent_left, ranges_left
from substructures.quantities.numbers.result import Evaluation, without_axis
from substructures.quantities.numbers.warnings import doubted, value_warnings
from substructures.quantities.quantity import CONDITION, FORWARD, REACTIONS, TABLE
from substructures.quantities.sources import PARTS, Sources, read_quantities, steps

#: the arguments that it takes, beside the quantities
STATE = ("q", "qd", "qdd", "t")
FIELDS = frozenset(("quantities", *STATE))


class OneState:
    """Quantities of a tree at single states: :func:`substructures.quantities.numbers.evaluation.evaluate` with all done
    beforehand that does not hang on the state.

    Parameters and inputs have their defaults. Whatever is unusual about a state is left to that function. Not
    for several threads at a time.
    """

    def __init__(self, sources: Sources, quantities: Sequence[str], kernel: Callable[[Program, list[str]], Kernel]):
        """``kernel``: for outputs of a program. Raises ValueError where single states need more than kernels, and
        MissingValue for a parameter without a default.
        """
        self._names, model = read_quantities(quantities), sources.model
        wanted = [TABLE[name] for name in self._names]
        if not model.dof or any(each.pivots or "along" in each.requires for each in wanted):
            raise ValueError("more than kernels is needed")
        self._model, self._judge = model, sources.judge
        self._state = {name: np.zeros(model.dof) for name in STATE[:-1]} | {"t": np.zeros(1)}
        self._needed = {field for each in wanted for field in each.requires} | {"q"}
        self._runs, self._numbers, found = self._bound(sources, kernel)
        self._results = {name: TABLE[name].of(found[TABLE[name].source]) for name in self._names}
        others = {symbol.name for each in sources.derived(self._names) for symbol in each.program.symbols}
        self._evaluation = partial(
            Evaluation,
            model.coordinates,
            1,
            model.program.digest,
            labels=sources.labels(self._names),
            single=True,
            warnings=(
                *value_warnings(sources, {}, (), None, others),
                *not_judged_warnings(doubted(sources, self._names)),
            ),
        )

    def at(self, given: Mapping[str, Any]) -> Evaluation | None:
        """The numbers for lists of numbers by FIELDS, in arrays that the next call overwrites; None where
        :func:`~substructures.quantities.numbers.evaluation.evaluate` has to be asked: other kinds, faults, limits
        that are left, results that are not finite.
        """
        if not (given.keys() <= FIELDS and self._read(given)):
            return None
        for run in self._runs:
            run()
        with np.errstate(invalid="ignore", over="ignore"):
            if not isfinite(np.add.reduce(self._numbers)):
                return None
        return self._evaluation({name: without_axis(value) for name, value in self._results.items()})

    def _read(self, given: Mapping[str, Any]) -> bool:
        """Take a state; False for what is no plain one within the limits of the joints."""
        for name, array in self._state.items():
            value = given.get(name)
            if value is None and name not in self._needed:
                array.fill(0.0)
                continue
            rows = [value] if name == "t" else value
            if type(rows) is not list or len(rows) != len(array) or any(type(x) in (bool, str, list) for x in rows):
                return False
            try:
                array[:] = rows
            except (TypeError, ValueError, OverflowError):
                return False
            if not isfinite(np.add.reduce(array)):
                return False
        names, q, judge = self._model.positions, self._state["q"][None], self._judge
        if self._model.reduced and (ranges_left(self._model, q[0], q[0]) or dependent_left(self._model, judge, q, {})):
            return False
        return judge is None or not (judge.left(names, q, {}) or judge.apart(names, q))

    def _bound(
        self, sources: Sources, kernel: Callable[[Program, list[str]], Kernel]
    ) -> tuple[list[Callable[[], None]], Array, dict[str, dict[str, Array]]]:
        """Calls of the kernels, one array for all that they write, and its parts by source and output."""
        values = self._values(sources)
        programs = list(steps(sources, self._names))
        if any(program is None or source in (CONDITION, PARTS, FORWARD, REACTIONS) for source, program, _ in programs):
            raise ValueError("more than kernels is needed")
        kernels = [(source, kernel(program, names), names) for source, program, names in programs if program]
        sizes = [prod(each.shape(name)) for _, each, names in kernels for name in names]
        numbers = np.zeros(sum(sizes))
        pieces = iter(np.split(numbers, np.cumsum(sizes)[:-1]))
        runs, found = list[Callable[[], None]](), dict[str, dict[str, Array]]()
        for source, each, names in kernels:
            out = {name: next(pieces).reshape((1, *each.shape(name))) for name in names}
            runs.append(each.bind(out, values))
            found.setdefault(source, {}).update(out)
        return runs, numbers, found

    def _values(self, sources: Sources) -> dict[str, Any]:
        """All symbols; those of the state as arrays that are read in place."""
        model = sources.model
        values: dict[str, Any] = dict.fromkeys(model.input_names, 0.0) | input_defaults(model.inputs)
        values |= default_numbers(sources.parameters(self._names))
        for primes, name in (("", "q"), ("'", "qd"), ("''", "qdd")):
            values |= {f"{c}{primes}": self._state[name][a : a + 1] for a, c in enumerate(model.coordinates)}
        return values | {"t": self._state["t"]}


def prepared(
    sources: Sources, quantities: Sequence[str], kernel: Callable[[Program, list[str]], Kernel]
) -> OneState | None:
    """:class:`OneState` where there can be one."""
    try:
        return OneState(sources, quantities, kernel)
    except (ValueError, MissingValue):
        return None
