"""How a program that was derived anew differs from the one that is stored for the same document."""

from __future__ import annotations

from dataclasses import dataclass

from substructures.expr.program import Program

SHORTER, MORE, OTHER, AS_IT_WAS = "shorter", "more formulas", "other", "as it was"


@dataclass(frozen=True, slots=True)
class Improvement:
    """Operations before and after, of the outputs that both have; ``outcome``: SHORTER, MORE (outputs that the stored
    program lacks), OTHER (as many operations or more, in another way) or AS_IT_WAS.
    """

    before: int
    after: int
    outcome: str

    @property
    def is_one(self) -> bool:
        """Whether the new program takes the place of the old one."""
        return self.outcome != AS_IT_WAS


def improvement(old: Program, new: Program) -> Improvement:
    """The comparison of two programs for the same document."""
    common = [name for name in old.outputs if name in new.outputs]
    before, after = (program.count(common)["total"] for program in (old, new))
    if old.digest == new.digest:
        return Improvement(before, after, AS_IT_WAS)
    if new.outputs.keys() - old.outputs.keys():
        return Improvement(before, after, MORE)
    return Improvement(before, after, SHORTER if after < before else OTHER)
