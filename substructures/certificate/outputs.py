"""Arrays of balls by name: what the outputs of a program have to be at one state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from flint import arb

from substructures.certificate.linear import Ball, Matrix


@dataclass
class Values:
    """The elements of one array that are not zero by structure; those that a symmetry gives are left out.

    ``scale``: what zeros are small against, where that is more than the largest element; ``others``: what elements may
    be as well, and whether something is left out then. ``along``: of a scalar that is known by its derivatives; then
    the elements are those by these symbols, coordinates, and behind them its value where all of them are zero (with
    velocities, inputs and the time halved). ``ways``: of rates among them, how symbols change for 1; these symbols stay
    as they are where coordinates are zero.
    """

    shape: tuple[int, ...]
    symmetry: str = "none"
    entries: dict[tuple[int, ...], Ball] = field(default_factory=dict)
    scale: Ball = field(default_factory=lambda: arb(0))
    others: dict[tuple[int, ...], list[tuple[Ball, bool]]] = field(default_factory=dict)
    along: tuple[str, ...] = ()
    ways: Mapping[str, Mapping[str, Ball]] = field(default_factory=dict)
    _size: Ball = None

    def like(self, index: tuple[int, ...], stored: Ball) -> tuple[Ball, bool]:
        """What an element has to be, and whether something is left out then: of several values the first that a stored
        one may be; not finite where one of them is not known.
        """
        likely = self.entries.get(index, arb(0)), False
        some = [likely, *self.others.get(index, ())]
        unknown = (x for x in some if not x[0].is_finite())
        return next((x for x in some if x[0].is_finite() and x[0].overlaps(stored)), next(unknown, likely))

    def size(self) -> Ball:
        """The largest element, or the scale."""
        if self._size is None:
            some = (x.abs_lower() for x in self.entries.values() if x.is_finite())
            self._size = max(some, default=self.scale).max(self.scale)
        return self._size


class Outputs(dict[str, Values]):
    """Values by name of the output."""

    def array(self, name: str, shape: tuple[int, ...], symmetry: str = "none") -> dict[tuple[int, ...], Ball]:
        """The elements of an array, to be filled in."""
        found = self.get(name)
        if found is None:
            found = self[name] = Values(shape, symmetry)
        return found.entries

    def matrix(self, name: str, shape: tuple[int, ...], index: tuple[int, ...], value: Matrix) -> None:
        """A matrix (of one column: a vector) at an index of the leading axes."""
        columns, vector = value.ncols(), len(shape) == len(index) + 1
        entries = self.array(name, shape)
        for k, x in enumerate(value.entries()):
            i, j = divmod(k, columns)
            entries[(*index, i) if vector else (*index, i, j)] = x

    def columns(self, name: str, shape: tuple[int, ...], index: Sequence[tuple[int, ...]], value: Matrix) -> None:
        """The columns of a matrix of three rows, each at its index."""
        entries, n = self.array(name, shape), value.ncols()
        for k, x in enumerate(value.entries()):
            i, j = divmod(k, n)
            entries[(*index[j], i)] = x

    def scalar(self, name: str, value: Ball) -> None:
        """An array without axes."""
        self.array(name, ())[()] = value


def images_of(index: tuple[int, ...], symmetry: str) -> list[tuple[tuple[int, ...], int]]:
    """The elements that one determines, with their signs: g_ab = g_ba; Gamma_abc = Gamma_acb, and for b <= a, c, where
    u_a and u_c move with what joint b turns, Gamma_abc = -Gamma_cba.
    """
    if symmetry == "symmetric":
        return [(index, 1), (index[::-1], 1)]
    if symmetry not in ("christoffel", "connection"):
        return [(index, 1)]
    a, b, c = index
    if symmetry == "connection":
        return [(index, 1), ((a, c, b), 1)]
    turned = [((c, b, a), -1), ((c, a, b), -1)] if b <= a and b <= c else []
    return [(index, 1), ((a, c, b), 1), *turned]
