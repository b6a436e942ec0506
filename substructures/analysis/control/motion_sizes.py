"""How large motions are that are demanded, so that micrometres are as well met as metres."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from substructures.array import Array
from substructures.tree.model import Model

#: changes that come from rounding, beside 1 or the state
ROUNDING = 1e-12
#: of the state: what is less is lost in its rounding where it is to be met to some digits
NEAR = 1e-6


def power_of_2(x: float) -> float:
    """The power of 2 next to a positive number; 1 where it is none."""
    return float(np.exp2(np.round(np.log2(x)))) if 0 < x < np.inf else 1.0


def motion_sizes(model: Model, first: Array, demands: Iterable[tuple[int, float]], horizon: float) -> Array:
    """Sizes of the changes of states (q, q') that are demanded, at most 1 [rad, m; s]: of all distances the largest, of
    all angles, at least a millionth of where they are; of rates this over the horizon. Powers of 2; of ball joints, and
    where nothing is demanded, 1.

    ``first``: the first state; ``demands``: numbers of its components, and what they are to be at the end [rad, m; s].
    """
    result, m = np.ones(len(first)), len(model.positions)
    changes = {i: abs(x - first[i]) for i, x in demands if abs(x - first[i]) > ROUNDING * max(1.0, abs(first[i]))}
    for kind in "RP":
        own = [a for a in range(model.dof) if model.joints[a] == kind and model.coordinates[a] in model.positions]
        places, rates = [model.positions.index(model.coordinates[a]) for a in own], [m + a for a in own]
        largest = max([changes.get(i, 0.0) * (horizon if i in rates else 1.0) for i in (*places, *rates)], default=0.0)
        least = NEAR * float(np.abs(first[places]).max(initial=0)) if largest else 0.0
        size = power_of_2(min(max(largest, least), 1.0))
        if size < 1:
            result[places], result[rates] = size, power_of_2(min(size / horizon, 1.0))
    return result
