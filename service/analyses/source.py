"""A tree with everything that an analysis may need of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from service.settings import Limits
from substructures.quantities.evaluation import Evaluator, interpreted
from substructures.quantities.reactions import ReactionModel
from substructures.quantities.regressor import RegressorModel
from substructures.tree.model import Model
from substructures.tree.plausibility import Plausibility


@dataclass(frozen=True)
class Source:
    """``digest``: of the tree; ``regressor``: derived when needed; ``folder``: where compiled kernels are kept;
    ``plausibility``: what judges values, made when needed; so are ``reactions``, where the parts are there,
    and ``grouped``: the model with base parameters.
    """

    model: Model
    digest: str
    regressor: Callable[[], RegressorModel]
    limits: Limits
    folder: Path | None = None
    engine: Evaluator = interpreted
    plausibility: Callable[[], Plausibility] | None = None
    reactions: Callable[[], ReactionModel] | None = None
    grouped: Callable[[], Model] | None = None
