"""What absolute angles of joints with parallel axes give beside the recursion: :mod:`.parallel_axes` makes it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from substructures.mechanics.composite_form import JointMomentum
from substructures.mechanics.evaluation_frames import Entries
from substructures.mechanics.linear3 import Scalar, Vector, dot


@dataclass(frozen=True)
class ByAngles:
    """What absolute angles give: g_ac and Gamma_abc of some joints c; of others, by joint, the moment of gravity on
    their lumps about their axes, and the parallel joints ``beyond``.
    """

    joints: frozenset[int] = frozenset()
    metric: Entries = field(default_factory=dict)
    christoffel: Entries = field(default_factory=dict)
    lumps: Mapping[int, Scalar] = field(default_factory=dict)
    beyond: Mapping[int, Sequence[int]] = field(default_factory=dict)

    def gravity(self, gamma: Sequence[Vector], momenta: Sequence[JointMomentum]) -> list[Scalar]:
        """Q_c of gravity; ``gamma``: in frame c."""
        Q: list[Scalar] = [0] * len(momenta)
        for c in reversed(range(len(momenta))):
            if c in self.lumps:
                # the moment about the axis of c is that of its lump and those about the parallel axes beyond
                Q[c] = self.lumps[c]
                for k in self.beyond[c]:
                    Q[c] = Q[c] + Q[k]
            else:
                # Q_c = gamma_c . p_c
                Q[c] = dot(gamma[c], momenta[c].p)
        return Q
