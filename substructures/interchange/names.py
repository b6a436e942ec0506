"""Names of files as names of definitions: other characters become ``_``, what is taken gets a number."""

from __future__ import annotations

import re
from collections.abc import Iterable

from substructures.expr.syntax import RESERVED
from substructures.part.topology import BASE

_LONGEST = 60


class Names:
    """Gives every name of a file a name of its own; ``given``: the mapping, in the order of the file."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {BASE, *RESERVED, *taken}
        self.given: dict[str, str] = {}

    def of(self, name: str) -> str:
        """The name for one of the file, always the same."""
        if name not in self.given:
            self.given[name] = self.new(name)
        return self.given[name]

    def new(self, wanted: str) -> str:
        """A name that nothing has, like the one that is wanted."""
        plain = re.sub(r"[^A-Za-z0-9_]", "_", wanted)[:_LONGEST]
        plain = plain if re.match(r"[A-Za-z]", plain) else f"x{plain}"[:_LONGEST]
        found, k = plain, 1
        while found in self._taken:
            k += 1
            found = f"{plain[: _LONGEST - 4]}_{k}"
        self._taken.add(found)
        return found


def library_name(wanted: str, otherwise: str = "imported") -> str:
    """A name of a substructure: small letters, digits and hyphens."""
    plain = re.sub(r"[^a-z0-9]+", "-", wanted.lower()).strip("-")[:64].strip("-")
    return plain or otherwise
