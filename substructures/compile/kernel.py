"""Kernels: a program compiled once, evaluated for one state or many."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.compile.arguments import NamedColumns, batch_shape, merged
from substructures.compile.recipe import needed_symbols
from substructures.expr.interpret import interpret
from substructures.expr.program import Output, Program

#: outputs of which only the independent elements are wanted: all, none, or these
Packed = bool | Collection[str]
#: of a decoded program, as measured: a tuple with its numbers
OPERATION_BYTES = 200


#: elements of outputs by name: their places in the dense array of a state, row by row
Places = Mapping[str, NDArray[np.int64]]
NO_PLACES: Places = MappingProxyType({})


class Evaluated(dict[str, Array]):
    """Arrays by name. ``finite``: it was seen that all their numbers are finite; otherwise that is not known."""

    finite = False


def is_packed(name: str, packed: Packed) -> bool:
    """Whether only the independent elements of this output are wanted."""
    return packed if isinstance(packed, bool) else name in packed


class KernelCall(NamedTuple):
    """What :meth:`Kernel.evaluate` is asked, checked; ``clean``: ``out`` holds zeros or earlier results; ``is_told``:
    whether results are finite is asked.
    """

    values: Mapping[str, Any]
    batch: tuple[int, ...]
    out: Mapping[str, Array]
    packed: Packed
    threads: int = 1
    clean: bool = True
    places: Places = NO_PLACES
    columns: Sequence[NamedColumns] = ()
    is_told: bool = False


@dataclass(frozen=True)
class Blocks:
    """Results as they leave the vector unit: ``array[vector, result, lane]``, state = vector * lanes + lane.

    ``places[name]``: the results that are the elements ``outputs[name].index``. The last vector is filled up with the
    last state.
    """

    count: int
    array: Array
    places: Mapping[str, NDArray[np.int64]]

    def entries(self, name: str) -> Array:
        """The independent elements of an output in rows, (states, elements)."""
        chosen = self.array[:, self.places[name]]
        vectors, size, lanes = chosen.shape
        return chosen.swapaxes(1, 2).reshape(vectors * lanes, size)[: self.count]


class Kernel(ABC):
    """Evaluates the outputs of a program. Safe to use from several threads at a time.

    ``values``: a float or an array of the common batch shape for every symbol, as for
    :func:`substructures.expr.interpret.interpret`; ``columns``: pairs of k names and an array batch + (k,) of their
    values, which is read in place. All methods raise MissingValue for a symbol without a value.
    """

    def __init__(self, program: Program, names: Sequence[str]) -> None:
        self.names = tuple(dict.fromkeys(names))
        self.outputs: Mapping[str, Output] = {name: program.outputs[name] for name in self.names}
        self.symbols = tuple(needed_symbols(program, self.names))

    @property
    @abstractmethod
    def compiled(self) -> bool:
        """False for the reference interpreter."""

    @property
    @abstractmethod
    def held(self) -> int:
        """Bytes that this kernel holds in memory at most, about."""

    def shape(self, name: str, packed: bool = False) -> tuple[int, ...]:
        """Shape of one state's output; packed: the elements of ``outputs[name].index`` only."""
        return (len(self.outputs[name].entries),) if packed else self.outputs[name].shape

    def evaluate(
        self,
        values: Mapping[str, Any],
        names: Iterable[str] | None = None,
        *,
        columns: Iterable[NamedColumns] = (),
        packed: Packed = False,
        threads: int = 1,
        places: Places = NO_PLACES,
    ) -> Evaluated:
        """Arrays of shape batch + :meth:`shape`; ``packed``: all or the named ones by independent elements only;
        ``places``: batch + (k,) with the k elements there, zeros included, of the outputs that are named.

        Same bits for any number of threads and any split of the batch."""
        columns = list(columns)
        batch = batch_shape(values, columns)
        out = Evaluated()
        request = KernelCall(values, batch, out, packed, threads, True, places, columns, is_told=True)
        for n in self.names if names is None else names:
            out[n] = self._new(n, request)
        out.finite = self._run(request)
        return out

    def evaluate_into(
        self,
        out: Mapping[str, Array],
        values: Mapping[str, Any],
        *,
        columns: Iterable[NamedColumns] = (),
        packed: Packed = False,
        threads: int = 1,
        clean: bool = False,
    ) -> None:
        """The same into arrays of the caller, (N, ...) with rows in C order. Raises ValueError when one does not fit.

        ``clean``: the arrays hold zeros, or results of an earlier call: elements that are always zero are not written.
        """
        columns = list(columns)
        batch = batch_shape(values, columns)
        self._check(out, batch, packed)
        self._run(KernelCall(values, batch, out, packed, threads, clean, columns=columns))

    def bind(
        self,
        out: Mapping[str, Array],
        values: Mapping[str, Any],
        *,
        columns: Iterable[NamedColumns] = (),
        packed: Packed = False,
    ) -> Callable[[], None]:
        """evaluate_into for these arrays, prepared: every call reads them anew. For one state at a time.

        Arrays of doubles with one axis or more are read in place, numbers are kept. Not for several threads at a time.
        """
        columns = list(columns)
        batch = batch_shape(values, columns)
        self._check(out, batch, packed)
        return self._bound(KernelCall(values, batch, out, packed, clean=False, columns=columns))

    @abstractmethod
    def blocks(
        self,
        values: Mapping[str, Any],
        *,
        columns: Iterable[NamedColumns] = (),
        threads: int = 1,
        out: Array | None = None,
    ) -> Blocks:
        """Independent elements of all outputs without any rearrangement: the fastest form. ``out``: the array of
        earlier blocks of the same shape, to be overwritten. Raises ValueError when it does not fit.
        """

    def _check(self, out: Mapping[str, Array], batch: tuple[int, ...], packed: Packed) -> None:
        for name, array in out.items():
            expected = batch + self.shape(name, is_packed(name, packed))
            fits = array.shape == expected and array.dtype == np.float64 and array.flags.writeable
            if not fits or not (array.flags.c_contiguous or _rows(array, batch)):
                raise ValueError(f"'{name}': a writable C-ordered array of doubles of shape {expected} is needed")

    def stream(
        self,
        batches: Iterable[tuple[Mapping[str, Any], Iterable[NamedColumns]]],
        names: Iterable[str] | None = None,
        *,
        packed: Packed = False,
        threads: int = 1,
    ) -> Iterator[dict[str, Array]]:
        """The results of one batch (values, columns) after the other, as :meth:`evaluate` gives them.

        All come in the same memory, as much as the largest batch needs: the next results overwrite the last ones.
        """
        wanted, held = tuple(self.names if names is None else names), 0
        memory: dict[str, Array] = {}
        for values, columns in batches:
            given = list(columns)
            batch = batch_shape(values, given)
            if prod(batch) > held or not memory:
                held = prod(batch)
                memory = {n: np.zeros((held, *self.shape(n, is_packed(n, packed)))) for n in wanted}
            out = {n: array[: prod(batch)].reshape(batch + array.shape[1:]) for n, array in memory.items()}
            self._run(KernelCall(values, batch, out, packed, threads, columns=given))
            yield out

    def _new(self, name: str, request: KernelCall) -> Array:
        """An array for an output."""
        given, packed = request.places.get(name), is_packed(name, request.packed)
        return np.empty(request.batch + (self.shape(name, packed) if given is None else given.shape))

    @abstractmethod
    def _run(self, request: KernelCall) -> bool:
        """Fills ``out``; whether it was seen that all results are finite, where this is asked."""

    @abstractmethod
    def _bound(self, request: KernelCall) -> Callable[[], None]:
        """The same for later."""


def _rows(array: Array, batch: tuple[int, ...]) -> bool:
    """Whether the elements of one state are contiguous, and states follow each other at one distance."""
    return len(batch) == 1 and len(array) > 0 and bool(array[0].flags.c_contiguous)


class InterpretedKernel(Kernel):
    """The reference interpreter in the same clothes, where LLVM is missing."""

    def __init__(self, program: Program, names: Sequence[str]) -> None:
        super().__init__(program, names)
        self.program = program

    @property
    def compiled(self) -> bool:
        """False."""
        return False

    @property
    def held(self) -> int:
        """Those of its program."""
        return OPERATION_BYTES * len(self.program)

    def blocks(
        self,
        values: Mapping[str, Any],
        *,
        columns: Iterable[NamedColumns] = (),
        threads: int = 1,
        out: Array | None = None,
    ) -> Blocks:
        """One lane."""
        columns = list(columns)
        count = prod(batch_shape(values, columns))
        found = self.evaluate(values, columns=columns, packed=True, threads=threads)
        rows = [found[n].reshape(count, -1) for n in self.names]
        ends = np.cumsum([0, *(row.shape[1] for row in rows)])
        places = {n: np.arange(a, b) for n, a, b in zip(self.names, ends[:-1], ends[1:], strict=True)}
        array = np.concatenate([*rows, np.zeros((count, 0))], axis=1)[..., None]
        if out is not None:
            out[...] = array
        return Blocks(count, array if out is None else out, places)

    def _run(self, request: KernelCall) -> bool:
        given = merged(request.values, request.columns)
        values = {n: v for n, v in given.items() if n in self.symbols}
        for name, result in interpret(self.program, values, list(request.out)).items():
            if name in request.places:
                result = elements(result, request.places[name], len(request.batch))
            elif is_packed(name, request.packed):
                result = _independent(self.outputs[name], result)
            request.out[name][...] = result
        return False

    def _bound(self, request: KernelCall) -> Callable[[], None]:
        def run() -> None:
            """The same again."""
            self._run(request)

        return run


def elements(dense: Array, places: NDArray[np.int64], axes: int = 1) -> Array:
    """The elements at places of an array with so many axes of the batch, along one axis."""
    chosen: Array = dense.reshape(*dense.shape[:axes], prod(dense.shape[axes:]))[..., places]
    return np.ascontiguousarray(chosen)  # NumPy puts chosen elements outside of all other axes, which JSON cannot write


def with_elements(found: Mapping[str, Array], places: Places) -> dict[str, Array]:
    """Arrays (N, ...) with the elements at places alone of those outputs that are named."""
    return {name: elements(x, places[name]) if name in places else x for name, x in found.items()}


def _independent(output: Output, result: Array) -> Array:
    """The elements at ``output.index`` along one last axis."""
    if not output.shape:
        return result[..., None][..., : len(output.entries)]
    index = np.array(output.index, dtype=np.int64).reshape(-1, len(output.shape))
    return result[(..., *index.T)]
