"""What is stored of trees beside their programs; made where they are computed, which takes its time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from service.content.integrity import checked
from service.content.summaries import UNKNOWN, PartContent, float_of
from service.content.tree_summaries import TreeSummary
from service.database.packed import unpack


@dataclass(frozen=True, slots=True)
class TreeContent:
    """What is stored of a coupled tree: canonical document, digest and length of its program, degrees of freedom,
    joints, mass in kg if it is known, the summary.

    ``parts``: the digest of the part that every instance is; ``program``: packed, None where it is stored already;
    ``inline``: the parts that the tree brings along; ``software``: that coupled it, empty for that of this process.
    """

    name: str
    spec: bytes
    program_digest: str
    nodes: int
    dof: int
    joints: str
    mass: float | None
    summary: TreeSummary
    parts: Mapping[str, str]
    program: bytes | None = None
    inline: Sequence[PartContent] = ()
    software: str = ""

    @property
    def shared(self) -> dict[str, bytes]:
        """What trees of its shape have in common, by digest."""
        found = {} if self.program is None else {self.program_digest: self.program}
        form, digest = self.summary.form, self.summary.form_digest
        return found if form is None or digest is None else {**found, digest: form.encode()}

    @classmethod
    def of_files(
        cls, told: Mapping[str, Any], files: Mapping[str, bytes], known: Mapping[str, bytes] = MappingProxyType({})
    ) -> TreeContent:
        """What a work of the kind ``assemble`` has told and made; ``known``: by digest what it was told not to send.
        Raises Refused for a program that is not what it is called.
        """
        inline = [PartContent.of_files(files, f"{name}.") for name in told["parts"] if f"{name}.program" in files]
        figures = told["program"], told["nodes"], told["dof"], told["joints"], float_of(told["mass"])
        summary, program = TreeSummary.of_files(files), files.get("program")
        if program is not None:
            checked("the program of a tree", told["program"], unpack(program))
        if summary.form is None and summary.form_digest is not None and summary.form_digest in known:
            summary = replace(summary, form=known[summary.form_digest].decode())
        program = known.get(told["program"]) if program is None else program
        made = summary, told["parts"], program, inline, told.get("software", UNKNOWN)
        return cls(told["name"], files["spec"], *figures, *made)
