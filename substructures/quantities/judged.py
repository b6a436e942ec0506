"""What is said of formulas that could not be judged: the documents give no finite value to hold them against."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from substructures.quantities.quantity import MODEL, TABLE
from substructures.quantities.sources import Sources, steps


def not_judged_warnings(quantities: Iterable[str]) -> list[dict[str, str]]:
    """A warning for each of these quantities, whose programs have outputs that are not judged."""
    return [
        {
            "pointer": "",
            "code": "not-judged",
            "message": f"'{name[:80]}' could not be judged: some of what it has to be by the documents has no finite "
            "value at any state that was tried",
        }
        for name in dict.fromkeys(quantities)
    ]


def doubted(sources: Sources, quantities: Sequence[str]) -> list[str]:
    """Those of the quantities whose numbers come from formulas that are not judged. Raises as :func:`steps`."""
    marks: dict[str, frozenset[str]] = {}
    for source, program, names in steps(sources, quantities):
        if program is not None and program.not_judged:
            marks[source] = program.not_judged.intersection(names)
    found = {name: marks.get(TABLE[name].source, frozenset()) for name in quantities}
    # of several outputs of a program its own; numbers that are solved for come from all
    return [n for n, some in found.items() if some & set(TABLE[n].outputs) or (some and TABLE[n].source != MODEL)]
