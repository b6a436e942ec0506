"""An analysis: what reads its request, what computes its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from service.models.requests import read_request
from service.models.results import Answered, trajectory_of
from service.models.source import Source
from service.models.warnings import warnings_of
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.errors import TooLarge
from substructures.tree.model import Model


@dataclass(frozen=True)
class Analysis:
    """``schema``: of the body; ``follow``: computes the result of a body that was read; ``needs_parts``: of the tree,
    beside its formulas."""

    schema: type[BaseModel]
    follow: Callable[[Source, Any, ProgressReport], Any]
    needs_parts: bool = False

    def read(self, body: Any, model: Model) -> BaseModel:
        """The body of a request about a tree. Raises InvalidInput with pointers."""
        return read_request(self.schema, body, model)

    def compute(self, source: Source, body: Any, report: ProgressReport) -> Answered:
        """The result for the body of a request, with warnings about it. Raises InvalidInput with pointers into it,
        MissingValue, TooLarge.
        """
        request = self.read(body, source.model)
        result = self.follow(source, request, report)
        return Answered(result, warnings_of(source, request, trajectory_of(result)))


def check_size(source: Source, states: int, numbers: int) -> None:
    """Raise TooLarge for an answer with so many numbers for each state."""
    size = 8 * states * numbers
    if size > source.limits.binary_bytes:
        raise TooLarge("the answer (in bytes)", size, source.limits.binary_bytes)


def without(given: Mapping[str, Any], *names: str) -> dict[str, Any]:
    """Arguments without some."""
    return {name: value for name, value in given.items() if name not in names}
