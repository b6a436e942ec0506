"""A tree with everything that an analysis may need of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from service.settings import Limits
from substructures.part.part import Part
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.numbers.evaluation import interpreted
from substructures.quantities.quantity import REGRESSOR
from substructures.quantities.regressor_model import RegressorModel
from substructures.quantities.sources import Sources
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model


@dataclass(frozen=True)
class Source:
    """``sources``: the model with what is derived of it when it is needed; ``digest``: of the tree; ``folder``: where
    compiled kernels are kept; ``parts``: the document and the parts by instance, where these are there.
    """

    sources: Sources
    digest: str
    limits: Limits
    folder: Path | None = None
    engine: Evaluator = interpreted
    parts: Callable[[], tuple[TreeSpec, Mapping[str, Part]]] | None = None

    @property
    def model(self) -> Model:
        """The model."""
        return self.sources.model

    def regressor(self) -> RegressorModel:
        """The regressor. Raises InvalidArgument without parts, TooLarge."""
        found = self.sources.of(REGRESSOR)
        if not isinstance(found, RegressorModel):
            raise TypeError("a regressor expected")
        return found

    def grouped(self) -> Model:
        """The model with base parameters, without parts the model. Raises TooLarge."""
        if self.parts is None:
            return self.model
        return couple(*self.parts(), self.limits.program_nodes, group=True)
