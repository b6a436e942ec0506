"""Exceptions of the package.

::

    SubstructuresError
    |-- InvalidInput         something given that cannot be used: faults with pointers
    |   |-- InvalidDocument  a definition, tree, expression or request
    |   `-- InvalidArgument  an argument of a function; pointers start with its name
    |-- TooLarge             something exceeds a limit: what, size, limit
    |-- InvalidProgram       a stored program that is damaged or of an unknown version: position
    |-- MissingValue         a symbol that needs a number has none: name
    `-- VerificationFailed   stored or derived formulas that disagree with their documents
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Self

#: unknown names of a request for which others are sought that are like them
SOUGHT = 20


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing wrong in a document or an argument. ``pointer`` is an RFC 6901 pointer, ``code`` is for programs."""

    pointer: str
    code: str
    message: str

    def __str__(self) -> str:
        return f"{self.pointer or '/'}: {self.message}"


def listed(names: Iterable[str], most: int = 12) -> str:
    """Names for a message: all of a few, the first of many."""
    found = list(names)
    return ", ".join(found[:most]) + (f", ... ({len(found)} in all)" if len(found) > most else "")


def meant(name: str, names: Iterable[str]) -> str:
    """What may have been meant by a name that is not among those there are; empty where nothing is like it.

    >>> meant("metrik", ["forces", "metric"])
    "; did you mean 'metric'?"
    """
    known = {each.lower(): each for each in names}
    found = get_close_matches(name[:80].lower(), known, n=1)
    return f"; did you mean '{known[found[0]]}'?" if found else ""


def among(name: object, names: Iterable[str], number: int = 0) -> str:
    """What may have been meant by a name, or else what there is; ``number``: how many unknown names came before, of
    which only the first are looked for.

    >>> among("metrik", ["forces", "metric"]), among("x", ["forces", "metric"])
    ("; did you mean 'metric'?", '; there are forces, metric')
    """
    found = list(names)
    return (meant(str(name), found) if number < SOUGHT else "") or f"; there are {listed(found) or 'none'}"


class SubstructuresError(Exception):
    """Root of all exceptions raised on purpose."""


class InvalidInput(SubstructuresError):
    """Something given that cannot be used; ``faults`` says where and why."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("; ".join(map(str, self.faults)))

    @classmethod
    def at(cls, pointer: str, code: str, message: str) -> Self:
        """The exception for a single fault."""
        return cls([Fault(pointer, code, message)])

    def moved(self, place: Callable[[str], str]) -> Self:
        """The same exception for whoever gave the input inside of something else: ``place`` maps its pointers."""
        return type(self)(replace(fault, pointer=place(fault.pointer)) for fault in self.faults)

    def below(self, place: str) -> Self:
        """:meth:`moved` below a pointer."""
        return self.moved(lambda pointer: place + pointer)


class InvalidDocument(InvalidInput):
    """A document or request that cannot be used; pointers lead into it."""


class InvalidArgument(InvalidInput):
    """An argument of a function that cannot be used; pointers start with its name: ``/q/0/1`` is ``q[0][1]``."""


class TooLarge(SubstructuresError):
    """Something exceeds a limit; nothing was done."""

    def __init__(self, what: str, size: int, limit: int) -> None:
        self.what, self.size, self.limit = what, size, limit
        super().__init__(f"{what}: {size:,}; the limit is {limit:,}")


class InvalidProgram(SubstructuresError):
    """A stored program that cannot be read; ``position`` is the index of the first bad operation, if any."""

    def __init__(self, message: str, position: int | None = None) -> None:
        self.position = position
        super().__init__(message if position is None else f"operation {position}: {message}")


class VerificationFailed(SubstructuresError):
    """Formulas disagree with their documents: a defect of this package, or damage. They are neither stored nor used."""


class MissingValue(SubstructuresError):
    """A symbol that needs a number has none."""

    def __init__(self, name: str, message: str = "") -> None:
        self.name = name
        super().__init__(message or f"'{name}' has no value: give one, or a default in its definition")
