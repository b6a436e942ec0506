"""A long list of statements cut into pieces of bounded length, with a workspace for what crosses a cut.

Compilers take more than linear time for one long function. The workspace is a scan of intervals: a place is free again
when the last piece that needs its value has taken it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

#: statements of a piece
LENGTH = 600
_TEMPORARY = re.compile(r"\bt(\d+)\b", re.ASCII)


@dataclass(frozen=True, slots=True)
class Body:
    """``taken`` and ``given``: (temporary, place in the workspace); ``statements``: (name, formula, is new)."""

    taken: tuple[tuple[int, int], ...]
    statements: tuple[tuple[str, str, bool], ...]
    given: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Pieces:
    """``slots``: places of the workspace; ``stack``: most doubles on the stack at a time."""

    bodies: tuple[Body, ...]
    slots: int
    stack: int


def uses(text: str) -> set[int]:
    """The temporaries in a formula."""
    return {int(n) for n in _TEMPORARY.findall(text)}


def split(temporaries: Sequence[tuple[int, str]], assigned: Sequence[tuple[str, str]], length: int = LENGTH) -> Pieces:
    """Temporaries, and elements of outputs as soon as they can be computed, in pieces of ``length`` statements."""
    statements = _ordered(temporaries, assigned)
    chunks = [statements[i : i + length] for i in range(0, len(statements), length)] or [[]]
    made = {int(name[1:]): k for k, chunk in enumerate(chunks) for name, _, is_new in chunk if is_new}
    needs = [set().union(*(uses(text) for _, text, _ in chunk)) for chunk in chunks]
    last = {n: k for k, some in enumerate(needs) for n in some}
    bodies, slots = _with_places(chunks, needs, made, last)
    local = max(len(b.taken) + sum(is_new for *_, is_new in b.statements) for b in bodies)
    return Pieces(tuple(bodies), slots, slots + local)


def _ordered(
    temporaries: Sequence[tuple[int, str]], assigned: Sequence[tuple[str, str]]
) -> list[tuple[str, str, bool]]:
    """Every element behind the last temporary, or the other element, that it needs."""
    after: dict[int, list[tuple[str, str, bool]]] = {}
    place: dict[str, int] = {}
    for name, text in assigned:
        copied = text.removeprefix("-")
        place[name] = place.get(copied, max(uses(text), default=0))
        after.setdefault(place[name], []).append((name, text, False))
    result = list(after.get(0, ()))
    for n, text in temporaries:
        result.append((f"t{n}", text, True))
        result += after.get(n, ())
    return result


def _with_places(
    chunks: Sequence[Sequence[tuple[str, str, bool]]],
    needs: Sequence[set[int]],
    made: Mapping[int, int],
    last: Mapping[int, int],
) -> tuple[list[Body], int]:
    free: list[int] = []
    slots, place, bodies = 0, dict[int, int](), list[Body]()
    for k, chunk in enumerate(chunks):
        taken = sorted(n for n in needs[k] if made[n] < k)
        took = tuple((n, place[n]) for n in taken)
        free += [place[n] for n in taken if last[n] == k]
        given = []
        for name, _, is_new in chunk:
            n = int(name[1:]) if is_new else -1
            if is_new and last.get(n, k) > k:
                if not free:
                    free.append(slots)
                    slots += 1
                place[n] = free.pop()
                given.append((n, place[n]))
        bodies.append(Body(took, tuple(chunk), tuple(given)))
    return bodies, slots
