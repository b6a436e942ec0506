"""Building formulas without looking for garbage in between.

All nodes of a graph refer to the graph, and it to them: one cycle that lives until the work is done. Python's collector
walks over it again and again while it grows, which takes as long as building it.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def without_collections(work: Callable[P, R]) -> Callable[P, R]:
    """A function during which cyclic garbage is not looked for, in no thread; afterwards its graph is the first found.

    Where collections are off already they stay off.
    """

    @wraps(work)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        """The work."""
        if not gc.isenabled():
            return work(*args, **kwargs)
        gc.disable()
        try:
            return work(*args, **kwargs)
        finally:
            gc.enable()

    return call
