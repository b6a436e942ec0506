"""A tree with everything that an analysis may need of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from service.settings import Limits
from substructures.part.part import Part
from substructures.quantities.evaluation import Evaluator, Sources, interpreted
from substructures.quantities.powers import PowerModel
from substructures.quantities.reactions import ReactionModel
from substructures.quantities.regressor import RegressorModel
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model
from substructures.tree.plausibility import Plausibility


@dataclass(frozen=True)
class Source:
    """``digest``: of the tree; ``regressor``: derived when needed; ``folder``: where compiled kernels are kept;
    ``plausibility``: what judges values, made when needed; so are ``reactions`` and ``powers``, where the parts are
    there, and ``grouped``: the model with base parameters; ``parts``: the document and the parts by instance.
    """

    model: Model
    digest: str
    regressor: Callable[[], RegressorModel]
    limits: Limits
    folder: Path | None = None
    engine: Evaluator = interpreted
    plausibility: Callable[[], Plausibility] | None = None
    reactions: Callable[[], ReactionModel] | None = None
    powers: Callable[[], PowerModel] | None = None
    grouped: Callable[[], Model] | None = None
    parts: Callable[[], tuple[TreeSpec, Mapping[str, Part]]] | None = None

    def sources(self) -> Sources:
        """What quantities are made from."""
        return Sources(self.model, regressor=self.regressor, reactions=self.reactions, powers=self.powers)
