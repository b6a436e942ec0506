"""The Jacobian of closures at a place, with the singular values that are asked for more than once along a motion."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.array import Array


class Rows:
    """Some rows ``G`` (r, n) of a balanced Jacobian: G = U S V^T, which is found when it is first needed, with the
    singular values ``values`` (k,), the largest first, ``left`` = U^T (k, r) and ``right`` = V (n, k), k = min(r, n).

    LinAlgError is raised for what is not finite.
    """

    def __init__(self, G: Array) -> None:
        self.G = G

    @cached_property
    def _svd(self) -> tuple[Array, Array, Array]:
        # G^T = V S U^T
        right, values, left, info = scipy.linalg.lapack.dgesdd(self.G.T, full_matrices=0)
        if info:
            raise np.linalg.LinAlgError("there are no singular values of what is not finite")
        return left, values, right

    left = property(lambda self: self._svd[0])
    values = property(lambda self: self._svd[1])
    right = property(lambda self: self._svd[2])

    def share(self, rank: int) -> float:
        """The rank-th singular value over the largest one, here or elsewhere: that is about 1."""
        values = self.values
        return 0.0 if len(values) < rank else float(values[rank - 1] / max(values[0], 1.0))


class Jacobian(Rows):
    """All rows of the balanced G at a place, each over its ``reach`` (see Constrained)."""

    def __init__(self, G: Array) -> None:
        super().__init__(G)
        self._some: dict[bytes, Rows] = {}

    def rows(self, rows: NDArray[np.int64]) -> Rows:
        """Those rows, in order."""
        if len(rows) == len(self.G):
            return self
        return self._some.setdefault(rows.tobytes(), Rows(self.G[rows]))
