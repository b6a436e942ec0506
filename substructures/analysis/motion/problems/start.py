"""Where a motion begins: a state, and what acts there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from substructures.analysis.arguments import Numbers, by_name
from substructures.analysis.motion.problems.signals import Signal
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.tree.model import Model

#: a number for each coordinate: (n,) in their order, or by name
StateVector = Numbers | Mapping[str, Any]


@dataclass(frozen=True)
class Start:
    """A state and what acts there: ``q`` [rad, m], ``qd`` [rad/s, m/s] (0 by default), ``parameters`` in place of their
    defaults, ``inputs`` [N m, N] by name (their defaults, or 0, where they are not given). Raises InvalidArgument.
    """

    q: StateVector | None
    qd: StateVector | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, Signal] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", by_name(self.parameters, "parameters"))
        object.__setattr__(self, "inputs", by_name(self.inputs, "inputs"))

    def with_defaults(self, model: Model) -> Start:
        """The same with the inputs that are not given at their defaults."""
        return replace(self, inputs=with_input_defaults(model.inputs, self.inputs))
