"""Where the elements of an output come from: tables for the runtime's ``scatter``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import NDArray

from substructures.compile.transposition import TILE
from substructures.expr.program import Output

Words = NDArray[np.int64]


@dataclass(frozen=True)
class Layout:
    """Tables of tiles of neighbouring elements, and of single elements.

    A row: byte offset in the caller's row; signs, bit k for element k; byte offset of every element's vector among the
    results. The first result is a zero. Tiles of nothing but zeros are left out: ``sparse`` says that the caller's
    array must have been zero before.
    """

    shape: tuple[int, ...]
    groups: Words
    singles: Words
    sparse: bool


def dense(output: Output, place: Mapping[int, int], width: int) -> Layout:
    """All elements, dependent ones filled in from the symmetry. ``place``: of operations among the results."""
    return _layout(output.shape, _codes(output, place), width)


def chosen(output: Output, place: Mapping[int, int], width: int, elements: Words) -> Layout:
    """The elements at these places of the dense array, row by row, in their order."""
    return _layout((len(elements),), _codes(output, place)[elements], width)


def _codes(output: Output, place: Mapping[int, int]) -> Words:
    codes = np.zeros(prod(output.shape), dtype=np.int64)
    strides = [prod(output.shape[k + 1 :]) for k in range(len(output.shape))]
    for index, entry, sign in output.expanded():
        at = sum(i * n for i, n in zip(index, strides, strict=True))
        codes[at] = 2 * place[entry] + (sign < 0)
    return codes


def packed(output: Output, place: Mapping[int, int], width: int) -> Layout:
    """The independent, structurally non-zero elements only, in the order of ``output.index``."""
    codes = np.array([2 * place[entry] for entry in output.entries], dtype=np.int64)
    return _layout((len(codes),), codes, width)


def _layout(shape: tuple[int, ...], codes: Words, width: int) -> Layout:
    """``codes``: 2 * place among the results, + 1 for a minus."""
    tile, size = min(TILE, width), len(codes)
    if size < tile:
        return Layout(
            shape, _rows(np.zeros(0, np.int64), codes, tile, width), _rows(np.arange(size), codes, 1, width), False
        )
    starts = np.arange(0, size, tile, dtype=np.int64)
    # the last tile overlaps the one before rather than the end of the row
    starts[-1] = size - tile
    used = codes[starts[:, None] + np.arange(tile)].any(axis=1)
    groups = _rows(starts[used], codes, tile, width)
    return Layout(shape, groups, _rows(np.zeros(0, np.int64), codes, 1, width), not bool(used.all()))


def _rows(starts: Words, codes: Words, tile: int, width: int) -> Words:
    """Rows of a table for the tiles that begin at the given elements."""
    tiles = codes[starts[:, None] + np.arange(tile)]
    signs = ((tiles & 1) << np.arange(tile)).sum(axis=1)
    rows = np.concatenate([8 * starts[:, None], signs[:, None], 8 * width * (tiles >> 1)], axis=1)
    return np.ascontiguousarray(rows, dtype=np.int64)
