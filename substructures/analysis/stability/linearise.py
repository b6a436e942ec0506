"""Linearisation of a model in numbers: a request as plain data in, matrices, modes and stability out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from substructures.analysis.stability.linearisation import Linearisation
from substructures.analysis.stability.linearise_closed import linearise_closed
from substructures.analysis.stability.linearise_tree import linearise_tree
from substructures.tree.model import Model


def linearise(model: Model, request: Mapping[str, Any]) -> Linearisation:
    """Perturbation equations and state-space matrices of any model; ``request``: see LinearisationRequest.

    Of a model with closures: linearise_closed, about one state in independent coordinates; else linearise_tree, about
    one state or states along a trajectory. Raises InvalidDocument (pointers; ``not-smooth`` for forces without
    derivative) and MissingValue.
    """
    return linearise_closed(model, request) if model.closures else linearise_tree(model, request)
