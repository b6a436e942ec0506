"""Damaged robot files: refused with a place or read as a definition, never another exception.

FUZZED_ROBOTS: so many cases of the long test (40,000).
"""

from __future__ import annotations

import os
import random
import re

import pytest

from substructures import Definition, TreeSpec
from substructures.errors import InvalidInput, TooLarge
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file

from .seeds import SEEDS

WORDS = (
    b"nan", b"inf", b"1e400", b"-1", b"0", b"", b"0 0 0", b"1 2", b"1e-320", b"1,5", b"0x10", b"__import__('os')",
    b"a.b",
    b"../etc/passwd", b"\xff", b"&lt;", b"&amp;", b"9" * 80, b"-0", b"1/0", b"base", b"t", b"true",
    b"\xc3\xa9", b"[]",
)  # fmt: skip
#: links at which files are cut; the seeds have these names
CUTS = ((), (), ("b",), ("c", "b"))
TAG = re.compile(rb"<[^>]+>")
VALUE = re.compile(rb'"([^"]*)"')
WORD = re.compile(rb"[\w.+-]+")


def mutated(data: bytes, rng: random.Random) -> bytes:
    """A file with one to four faults in it."""
    for _ in range(rng.randint(1, 4)):
        data = rng.choice((_value, _value, _word, _tag_gone, _tag_twice, _swapped, _flipped, _cut))(data, rng)
    return data


def _place(pattern: re.Pattern[bytes], data: bytes, rng: random.Random) -> tuple[int, int]:
    found = list(pattern.finditer(data))
    return rng.choice(found).span() if found else (0, 0)


def _value(data: bytes, rng: random.Random) -> bytes:
    start, end = _place(VALUE, data, rng)
    new = rng.choice((rng.choice(WORDS), rng.choice(VALUE.findall(data) or [b""])))
    return data[:start] + b'"' + new + b'"' + data[end:]


def _word(data: bytes, rng: random.Random) -> bytes:
    start, end = _place(WORD, data, rng)
    return data[:start] + rng.choice((rng.choice(WORDS), rng.choice(WORD.findall(data) or [b""]))) + data[end:]


def _tag_gone(data: bytes, rng: random.Random) -> bytes:
    start, end = _place(TAG, data, rng)
    return data[:start] + data[end:]


def _tag_twice(data: bytes, rng: random.Random) -> bytes:
    start, end = _place(TAG, data, rng)
    return data[:end] + data[start:end] + data[end:]


def _swapped(data: bytes, rng: random.Random) -> bytes:
    (a, b), (c, d) = sorted(_place(TAG, data, rng) for _ in range(2))
    return data if c < b else data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def _flipped(data: bytes, rng: random.Random) -> bytes:
    i = rng.randrange(len(data) + 1)
    return data[:i] + bytes([rng.randrange(256)]) + data[i + 1 :]


def _cut(data: bytes, rng: random.Random) -> bytes:
    return data[: rng.randrange(len(data) + 1)] if rng.random() < 0.2 else data


def survives(data: bytes, options: Options, cut: tuple[str, ...] = ()) -> bool:
    """Whether it is read; what is read is a definition, or a tree, and what is refused says where."""
    try:
        found = import_file(data, options, cut=cut)
    except (InvalidInput, TooLarge):
        return False
    Definition.read(found.definition)
    if found.tree is not None:
        TreeSpec.read(found.tree)
    return True


def fuzz(cases: int, seed: int) -> int:
    """So many cases; the number of those that were read."""
    rng, read = random.Random(seed), 0  # noqa: S311 -- repeatable
    for k in range(cases):
        data = mutated(rng.choice(SEEDS), rng)
        options = Options(
            rng.choice(("none", "inertia", "all")),
            rng.choice(("ports", "bodies", "dropped")),
            rng.choice(("fixed", "floating")),
            rng.choice(("angles", "quaternions")),
        )
        try:
            read += survives(data, options, rng.choice(CUTS))
        except Exception as error:
            raise AssertionError(f"case {k} of seed {seed}: {type(error).__name__}: {error}\n{data!r}") from error
    return read


def test_damaged_files_are_refused_or_read() -> None:
    assert 0 < fuzz(2000, 0) < 2000


@pytest.mark.deep
@pytest.mark.parametrize("seed", range(1, 11))
def test_many_damaged_files_are_refused_or_read(seed: int) -> None:
    assert fuzz(int(os.environ.get("FUZZED_ROBOTS", "40000")) // 10, seed) > 0
