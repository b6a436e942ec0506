"""What is stored of parts beside their programs; made where they are computed, which takes its time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from service.content.derivation import software
from service.content.integrity import checked
from service.database.packed import pack, unpack
from substructures.documents import read_json, write_json
from substructures.part.mass import mass_at_defaults
from substructures.part.part import Part

UNKNOWN = "unknown"  # software


@dataclass(frozen=True, slots=True)
class PartContent:
    """What is stored of a part: its packed program with so many nodes, and more.

    ``row``: columns of the table; ``formulas``: of every addressable formula position, quantity, body, coordinate,
    shape, symmetry, operations, output and index.
    """

    program: bytes
    nodes: int
    row: Mapping[str, Any]
    formulas: Sequence[Sequence[Any]]

    @property
    def name(self) -> str:
        """Name of the definition."""
        return str(read_json(self.row["definition"].encode())["name"])

    @property
    def digest(self) -> str:
        """Digest of the definition."""
        return str(self.row["digest"])

    def files(self) -> dict[str, bytes]:
        """As files of an outcome."""
        members = {"nodes": self.nodes, "row": self.row, "formulas": self.formulas}
        return {"program": self.program, "content": write_json(members)}

    @classmethod
    def of_files(cls, files: Mapping[str, bytes], prefix: str = "") -> PartContent:
        """Out of the files of an outcome, which may be of another version of the software. Raises Refused for a program
        or a definition that is not the one that it is called.
        """
        members, program = read_json(files[f"{prefix}content"]), files[f"{prefix}program"]
        row = {"software": UNKNOWN, **members["row"], "mass": float_of(members["row"]["mass"])}
        checked("a program", row["program"], unpack(program))
        checked("a definition", row["digest"], row["definition"].encode())
        return cls(program, members["nodes"], row, members["formulas"])


def part_content(part: Part, recipe: str | None = None) -> PartContent:
    """What is stored of a part that was derived here, by a ``recipe`` where it is a published tree; the operations of
    its formulas are counted one by one.
    """
    definition = part.definition
    words = (definition.name, definition.title, definition.description, *definition.tags)
    row = {
        "digest": definition.digest,
        "program": part.program.digest,
        "definition": definition.canonical().decode(),
        "title": _plain(definition.title),
        "description": _plain(definition.description),
        "searchable": _plain("\n".join(words).lower()),
        "source": _plain(definition.source.lower()),
        "mass": mass_at_defaults(definition),
        "dof": part.dof,
        "joints": part.joints,
        "tags": _json(definition.tags),
        "coordinates": _json(part.coordinates),
        "bodies": _json(part.bodies),
        "ports": _json(part.ports),
        "parameters": _json(part.parameters),
        "operations": _json(part.operations),
        "certificate": _json(part.certificate),
        "software": software(),
        "recipe": recipe,
    }
    formulas = [
        (k, f.quantity, f.body, f.coordinate, _json(f.shape), f.symmetry, f.operations, f.output, _json(f.index))
        for k, f in enumerate(part.formulas())
    ]
    return PartContent(pack(part.program), len(part.program), row, formulas)


def float_of(number: Any) -> float | None:
    """A number out of JSON as the double that it was."""
    return None if number is None else float(number)


def _plain(text: str) -> str:
    """Without NUL, which PostgreSQL cannot store outside of JSON's escapes."""
    return text.replace("\0", "")


def _json(value: Any) -> str:
    return write_json(value).decode()
