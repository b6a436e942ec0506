"""Springs and dampers along and about the three axes of a frame.

With d_i the components of d in the axes e_i of A (``from``), m_j the axes of B (``to``), and w_a what a unit force or
moment does for q'^a = 1 (:mod:`.pairs`):

    Q_a = -(k_i d_i + c_i d_i') d(d_i)/dq^a + (h_j (m_j x e_j)_i - c_i w_i) w_ia,
    V = k_i/2 d_i^2 + h_j (1 - m_j . e_j),   h_j = (k_1 + k_2 + k_3)/2 - k_j of angles
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Literal

from pydantic import Field

from substructures.documents.fields import NumberVector
from substructures.documents.units import Dimension
from substructures.loads.document import NONE, EndsOfPart, EndsOfTree, Load, LoadFormulas
from substructures.loads.names import Names
from substructures.loads.pairs import rate
from substructures.loads.scope import ExprVector
from substructures.loads.units import ANGULAR_DAMPING, ANGULAR_STIFFNESS, DAMPING, STIFFNESS
from substructures.mechanics.linear3 import IDENTITY, add, cross, scale

HALF = Fraction(1, 2)


class _Bushing(Load):
    dimensions: ClassVar[Mapping[str, Dimension]] = {
        "stiffness": STIFFNESS,
        "damping": DAMPING,
        "angular_stiffness": ANGULAR_STIFFNESS,
        "angular_damping": ANGULAR_DAMPING,
    }
    is_elastic: ClassVar[bool] = True

    type: Literal["bushing"]
    stiffness: NumberVector = Field(NONE, description="N/m; along the three axes")
    damping: NumberVector = Field(NONE, description="N s/m; along the three axes")
    angular_stiffness: NumberVector = Field(NONE, description="N m/rad; about the three axes")
    angular_damping: NumberVector = Field(NONE, description="N m s/rad; about the three axes")

    def law(self, names: Names, pointer: str) -> BushingLaw | None:
        """Its ends and numbers."""
        ends = [names.end(end) for end in self.ends(pointer)]
        numbers = [names.vector(getattr(self, name), f"{pointer}/{name}") for name in self.dimensions]
        return None if None in ends else BushingLaw(self, pointer, ends, *numbers)


class BushingLoad(EndsOfPart, _Bushing):
    """Springs and dampers along and about the three axes of the frame ``from``, between the origins of both frames.

    d: from the origin of ``from`` to that of ``to``, forces -k_i d_i - c_i d_i' on ``to`` along the axes of ``from``.
    The angular springs have the potential sum_j h_j (1 - e_j . m_j) of the axes e_j of ``from`` and m_j of ``to``, with
    h_j = (k_1 + k_2 + k_3)/2 - k_j: moments -k_i theta_i for small angles.
    """


class Bushing(EndsOfTree, _Bushing):  # noqa: D101 -- that of parts
    __doc__ = BushingLoad.__doc__


@dataclass(frozen=True)
class BushingLaw:
    """Its ends, stiffness and damping along and about the three axes of A."""

    load: _Bushing
    pointer: str
    ends: list[Any]
    stiffness: ExprVector
    damping: ExprVector
    angular_stiffness: ExprVector
    angular_damping: ExprVector

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Forces and potential, along and about the axes."""
        graph, k, ka = names.graph, self.stiffness, self.angular_stiffness
        pair = names.pair(self.ends)
        d, m = tuple(map(graph.lift, pair.d_A)), pair.axes
        # h_j of the angular springs; their moment h_j m_j x e_j in the axes of A
        h = [(ka[0] + ka[1] + ka[2]) * HALF - ka[j] for j in range(3)]
        moments = [scale(h[j], cross(m[j], IDENTITY[j])) for j in range(3)]
        turning = [graph.lift(x) for x in add(add(moments[0], moments[1]), moments[2])]
        pushing = [-k[i] * d[i] for i in range(3)]
        for push, damping, way in ((pushing, self.damping, pair.along), (turning, self.angular_damping, pair.about)):
            for i in range(3):
                if not (push[i].is_zero and damping[i].is_zero):
                    reach = way(i)
                    found.add(reach, push[i] - damping[i] * rate(graph, reach, names.rates))
        along = graph.sum(k[i] * d[i] ** 2 * HALF for i in range(3))
        about = graph.sum(h[j] * (1 - graph.lift(m[j][j])) for j in range(3))
        for field, energy in (("stiffness", along), ("angular_stiffness", about)):
            is_steady = names.is_steady(*getattr(self.load, field))
            found.keep(names.kept(energy, is_steady, f"{self.pointer}/{field}"))
