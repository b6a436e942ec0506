"""Bundles that are wrong, with what is said of them, and bundles whose formulas are not those of their definitions."""

from __future__ import annotations

import io
import json
import stat
import struct
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

from service.content.bundles import LIST, MOST_PARTS
from substructures.certificate.part_outputs import part_symbols
from substructures.certificate.states import draws
from substructures.certificate.written import plain
from substructures.documents import write_json
from substructures.part.definition import Definition

from .bundle_files import (
    Files,
    changed_program,
    consistent,
    listed,
    packed,
    path_of,
)
from .conftest import PENDULUM


@dataclass
class Wrong:
    """A bundle that is refused: with this code, at a pointer that ends so, with these words."""

    make: Callable[[Files], bytes]
    code: str
    pointer: str
    words: str = ""


def without(name: str) -> Callable[[Files], bytes]:
    return lambda files: packed({path: data for path, data in files.items() if not path.endswith(name)})


def beside(name: str, mode: int = 0) -> Callable[[Files], bytes]:
    """With one file more, of a mode."""

    def make(files: Files) -> bytes:
        buffer = io.BytesIO(packed(files))
        with zipfile.ZipFile(buffer, "a") as archive:
            info = zipfile.ZipInfo(name)
            info.external_attr = mode << 16
            archive.writestr(info, b"x")
        return buffer.getvalue()

    return make


def with_list(change: Callable[[Any], None]) -> Callable[[Files], bytes]:
    return lambda files: packed(listed(files, change))


def with_program(change: Callable[[Any], None]) -> Callable[[Files], bytes]:
    return lambda files: packed(changed_program(files, change))


def with_definition(change: Callable[[Any], None], form: Callable[[Any], bytes] = write_json) -> Callable[..., bytes]:
    def make(files: Files) -> bytes:
        path = path_of(files, "slider", "definition.json")
        document = json.loads(files[path])
        change(document)
        return packed(consistent(files, path, form(document)))

    return make


def touched(name: str) -> Callable[[Files], bytes]:
    """One byte of a file is another."""

    def make(files: Files) -> bytes:
        path = path_of(files, "slider", name)
        data = files[path]
        return packed({**files, path: data[:-2] + bytes([data[-2] ^ 1]) + data[-1:]})

    return make


def twice(files: Files) -> bytes:
    buffer = io.BytesIO(packed(files))
    path = path_of(files, "slider", "/program")
    with zipfile.ZipFile(buffer, "a") as archive, pytest.warns(UserWarning, match="Duplicate name"):
        archive.writestr(path, files[path])
    return buffer.getvalue()


def bomb(files: Files) -> bytes:
    """A hundred megabytes in a hundred kilobytes."""
    return packed({**files, path_of(files, "pendulum", "/program"): bytes(10**8)}, zipfile.ZIP_DEFLATED)


def shy_bomb(files: Files) -> bytes:
    """The same, and its directory says that it is small."""
    return bomb(files).replace(struct.pack("<I", 10**8), struct.pack("<I", 1000))


def long_definition(files: Files) -> bytes:
    return packed({**files, path_of(files, "slider", "definition.json"): b" " * 20 * 2**20}, zipfile.ZIP_DEFLATED)


def many_files(files: Files) -> bytes:
    return packed({**files, **{f"{k}.txt": b"" for k in range(3 * MOST_PARTS)}})


def negated(program: Any) -> None:
    """A sign of the metric is wrong."""
    output = program["outputs"]["metric"]
    program["operations"].append(["neg", output["entries"][0]])
    output["entries"][0] = len(program["operations"]) - 1


def no_inertia(program: Any) -> None:
    del program["outputs"]["composite.m"]


def no_tilt(program: Any) -> None:
    del program["outputs"]["E.tilt"]


def flat_turn(program: Any) -> None:
    program["outputs"]["E.turn"] |= {"shape": [], "index": [[]], "entries": program["outputs"]["E.turn"]["entries"][:1]}


def append(program: Any, *operations: list[Any]) -> int:
    """The number of the last operation; operands that are counted from 0 are those of what is appended."""
    program["operations"] += operations
    return len(program["operations"]) - 1


def added_to_metric(program: Any, *operations: list[Any]) -> None:
    """The metric plus the last of operations."""
    entries = program["outputs"]["metric"]["entries"]
    added = append(program, *operations)
    entries[0] = append(program, ["add", entries[0], added])


def bump(program: Any) -> None:
    """metric + 1000 exp(-1e8 (q - 1/2)^2): nothing but near to q = 1/2."""
    q = next(k for k, symbol in enumerate(program["symbols"]) if symbol["kind"] == "coordinate")
    n = len(program["operations"])
    exponent = [["sym", q], ["rat", "1", "2"], ["sub", n, n + 1], ["powi", n + 2, 2], ["int", "-100000000"]]
    more = [["mul", n + 3, n + 4], ["exp", n + 5], ["int", "1000"], ["mul", n + 6, n + 7]]
    added_to_metric(program, *exponent, *more)


def wrong_elsewhere(program: Any) -> None:
    """metric + (l - c), where c is the l of the state that every certificate of this part is made at."""
    kinds = part_symbols(plain(Definition.read(PENDULUM)))
    (state,) = next(draws(kinds, {}, 1))
    known = state["l"]
    number = next(k for k, symbol in enumerate(program["symbols"]) if symbol["name"] == "l")
    n = len(program["operations"])
    rational = ["rat", str(known.numer()), str(known.denom())]
    added_to_metric(program, ["sym", number], rational, ["sub", n, n + 1])


def swapped(program: Any) -> None:
    """Rows of an array in another order."""
    entries = program["outputs"]["port.r"]["entries"]
    entries[0], entries[-1] = entries[-1], entries[0]


def longer(program: Any) -> None:
    """m + 0 for every mass."""
    output = program["outputs"]["composite.m"]
    program["operations"] += [["int", "0"], ["add", output["entries"][0], len(program["operations"])]]
    output["entries"][0] = len(program["operations"]) - 1


def other_unit(program: Any) -> None:
    next(symbol for symbol in program["symbols"] if symbol["kind"] == "parameter")["unit"] = "furlong"


def foreign_symbol(program: Any) -> None:
    program["symbols"][0]["name"] = "zz"


def later_operand(program: Any) -> None:
    program["operations"][0] = ["neg", 5]


def newer(document: Any) -> None:
    document["version"] = 3


def number_of_none(document: Any) -> None:
    document["parts"][0]["number"] = 0


def format_of(value: Any) -> Callable[[Any], None]:
    """Something else than a whole number as the number of the format."""

    def change(document: Any) -> None:
        document["version"] = value

    return change


def number_of(value: Any) -> Callable[[Any], None]:
    """Something else than a whole number in the place of one."""

    def change(document: Any) -> None:
        document["parts"][0]["number"] = value

    return change


def other_name(document: Any) -> None:
    document["parts"][1]["name"] = "pendulum2"


def other_program(document: Any) -> None:
    document["parts"][0]["program"] = document["parts"][1]["program"]


def climbing(document: Any) -> None:
    document["parts"][0]["folder"] = "../x"


def fewer(document: Any) -> None:
    del document["parts"][1]


def heavier(document: Any) -> None:
    document["bodies"][0]["mass"] = "2*m"


def impossible(document: Any) -> None:
    document["bodies"][0]["mass"] = -1


def unknown_field(document: Any) -> None:
    document["colour"] = "red"


def spaced(document: Any) -> bytes:
    return json.dumps(document).encode()


def same(_document: Any) -> None:
    return None


WRONG: dict[str, Wrong] = {
    "nothing": Wrong(lambda _: b"", "invalid-bundle", "", "not a zip"),
    "no zip": Wrong(lambda _: b"PK and more", "invalid-bundle", "", "not a zip"),
    "cut off": Wrong(lambda files: packed(files)[:-40], "invalid-bundle", ""),
    "no list": Wrong(without(LIST), "invalid-bundle", "/bundle.json", "missing"),
    "no program": Wrong(without("/program"), "invalid-bundle", "/program", "missing"),
    "a file more": Wrong(beside("notes.txt"), "invalid-bundle", "/notes.txt", "does not list"),
    "a path upwards": Wrong(beside("../../etc/cron"), "invalid-bundle", "/../../etc/cron", "leads out"),
    "an absolute path": Wrong(beside("/etc/cron"), "invalid-bundle", "//etc/cron", "leads out"),
    "a path of Windows": Wrong(beside("C:\\x"), "invalid-bundle", "", "leads out"),
    "a link": Wrong(beside("link", stat.S_IFLNK | 0o777), "invalid-bundle", "/link", "a link, a folder"),
    "a folder": Wrong(beside("folder/"), "invalid-bundle", "/folder/", "a link, a folder"),
    "a file twice": Wrong(twice, "invalid-bundle", "/program", "twice"),
    "lzma": Wrong(lambda files: packed(files, zipfile.ZIP_LZMA), "invalid-bundle", "", "deflate"),
    "a bomb": Wrong(bomb, "too-large", "/program", "67,1"),
    "a bomb that says it is small": Wrong(shy_bomb, "invalid-bundle", ""),
    "a long definition": Wrong(long_definition, "too-large", "/definition.json"),
    "many files": Wrong(many_files, "too-large", "", "number of files"),
    **{
        f"{value!r} as a number": Wrong(with_list(number_of(value)), "invalid-document", "/bundle.json/parts/0/number")
        for value in (True, "1", 1.5, [1])
    },
    **{
        f"{value!r} as the format": Wrong(
            with_list(format_of(value)), "invalid-bundle", "/bundle.json/version", "number"
        )
        for value in (True, "2", 1.5)
    },
    "a number of no version": Wrong(with_list(number_of_none), "invalid-document", "/bundle.json/parts/0/number", "1"),
    "a newer format": Wrong(with_list(newer), "newer-format", "/bundle.json/version", "format 3"),
    "another format": Wrong(with_list(lambda d: d.update(format="x")), "invalid-bundle", "/bundle.json/format"),
    "a list that is none": Wrong(lambda files: packed({**files, LIST: b"[1"}), "invalid-document", "/bundle.json"),
    "an empty list": Wrong(with_list(lambda d: d.update(parts=[])), "too-large", "/bundle.json/parts"),
    "an unknown field": Wrong(with_list(lambda d: d.update(note="x")), "invalid-document", "/bundle.json/note"),
    "another name": Wrong(with_list(other_name), "invalid-bundle", "/bundle.json/parts/1/folder"),
    "another folder": Wrong(with_list(climbing), "invalid-bundle", "/definition.json", "missing"),
    "a part that is not listed": Wrong(with_list(fewer), "invalid-bundle", "", "does not list"),
    "another program's digest": Wrong(with_list(other_program), "wrong-digest", "/program"),
    "a byte of the definition": Wrong(touched("definition.json"), "wrong-digest", "/definition.json"),
    "a byte of the program": Wrong(touched("/program"), "wrong-digest", "/program"),
    "a byte of the certificate": Wrong(touched("certificate.json"), "wrong-digest", "/certificate.json"),
    "an impossible body": Wrong(with_definition(impossible), "invalid-document", "/definition.json/bodies/0/mass"),
    "an unknown member": Wrong(with_definition(unknown_field), "invalid-document", "/definition.json/colour"),
    "another text": Wrong(with_definition(same, spaced), "wrong-digest", "/definition.json", "canonical"),
}


def with_certificate(certificate: Any) -> Callable[[Files], bytes]:
    def make(files: Files) -> bytes:
        path = path_of(files, "pendulum", "certificate.json")
        return packed(consistent(files, path, write_json(certificate)))

    return make


FOREIGN: dict[str, Callable[[Files], bytes]] = {
    "a wrong sign": with_program(negated),
    "no inertia": with_program(no_inertia),
    "no factor": with_program(no_tilt),
    "a factor that is no array": with_program(flat_turn),
    "another unit": with_program(other_unit),
    "a foreign symbol": with_program(foreign_symbol),
    "a right program of another version": with_program(longer),
    "a bump": with_program(bump),
    "right at the states of certificates": with_program(wrong_elsewhere),
    "swapped rows": with_program(swapped),
    "no program at all": with_program(later_operand),
    "no text at all": lambda files: packed(
        consistent(files, path_of(files, "pendulum", "/program"), b"\xff no program")
    ),
}
