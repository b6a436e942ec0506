"""Integrals of whatever moves freely, in a constant force F or in none (Galilei, Huygens; notation.md, section 7).

With P' = F constant along an axis, s the first moment of all masses, s' = P, and m the mass of the whole,

    P - F t,        s - P t + F t^2 / 2,        L - s x P / m

are constant: the last is the spin about the mass centre, where gravity has no moment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import takewhile

from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.integral import Integral, IntegralKind
from substructures.expr.calculus.integrate import potential
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Symbol
from substructures.mechanics.balls import turned_by

AXES = "xyz"
#: operations of models whose mass centre is looked for, and terms of its derivatives
LIMIT, TERMS = 20_000, 200
#: rates of a joint that turns alone
TURNS = 3


@dataclass(frozen=True)
class FreeMotion:
    """``linear``, ``angular``: momenta of the whole; ``rates``: their derivatives along the motion, (3,) each.

    ``pull``: P' where it is constant, else None; ``constant``: of a formula that depends on parameters alone its value.
    """

    f: ModelFormulas
    linear: Sequence[Expr]
    angular: Sequence[Expr]
    pull: Sequence[Expr | None]
    constant: Callable[[Expr], Expr | None]
    vanishes: Callable[[Expr], bool]
    moments: dict[int, Expr | None] = field(default_factory=dict)

    def with_time(self) -> Iterator[tuple[Integral, Expr]]:
        """P - F t along the first axis with a force (what is across it has none), and s - P t + F t^2 / 2."""
        f = self.f
        f.symbols.setdefault("t", Symbol("t", "time", "s"))
        t = f.graph.symbol("t")
        acting = [i for i, force in enumerate(self.pull) if force is not None and not self.vanishes(force)]
        for i in acting[:1]:
            reason = f"the force along {AXES[i]} is constant: the momentum changes by F t"
            yield self._integral("impulse", i, "N s", reason), self.linear[i] - (self.pull[i] or f.graph.zero) * t
        for i, force in enumerate(self.pull):
            s = self._moment(i)
            if s is not None and force is not None:
                reason = f"the mass centre moves along {AXES[i]} as one point in a constant force, or in none (Galilei)"
                yield self._integral("galilei", i, "kg m", reason), s - self.linear[i] * t + force * t * t / 2

    def spin(self) -> Iterator[tuple[Integral, Expr]]:
        """L - s x P / m about the axes about which there is a moment through the origin."""
        mass = self._mass()
        for i in range(3) if mass is not None else ():
            j, k = (i + 1) % 3, (i + 2) % 3
            s, r = self._moment(j), self._moment(k)
            if mass is None or s is None or r is None or self.vanishes(self.angular[i]):
                continue
            value = self.angular[i] - (s * self.linear[k] - r * self.linear[j]) / mass
            own, about = self.f.rate([self.angular[i], value])
            if not self.vanishes(own) and self.vanishes(about):
                reason = f"gravity, loads and the world exert no moment about the mass centre along {AXES[i]}"
                yield self._integral("spin", i, "N m s", reason), value

    @staticmethod
    def _integral(kind: IntegralKind, axis: int, unit: str, reason: str) -> Integral:
        return Integral(f"{kind}.{AXES[axis]}", kind, "constant", unit, reason)

    def _moment(self, i: int) -> Expr | None:
        """s_i with ds_i/dq^a = the momentum of a unit velocity, where P_i' is constant; None where none is found."""
        if i not in self.moments:
            f = self.f
            known = f.elements("linear_momentum")
            columns = [-known.get((a, i), f.graph.zero) for a in range(f.n)]
            wanted = self.pull[i] is not None and not all(x.is_zero for x in columns) and len(f.model.program) <= LIMIT
            find = self._carried if f.model.balls else lambda _: potential(columns, f.model.coordinates, TERMS)
            self.moments[i] = find(i) if wanted else None
        return self.moments[i]

    def _carried(self, i: int) -> Expr | None:
        """s_i = m p_i + (R c)_i of a floating joint that carries all: in its axes P is m v + w x c."""
        f, momenta = self.f, self.f.elements("linear_momentum")
        for ball in (ball for ball in f.model.balls if len(ball["velocities"]) > TURNS):
            *slides, x, y, z = (f.model.coordinates.index(name) for name in ball["velocities"])
            *place, w, a, b, c = map(f.graph.symbol, ball["positions"])
            E = turned_by((w, a, b, c), 2 / (w * w + a * a + b * b + c * c))
            of = {k: [momenta.get((k, j), f.graph.zero) for j in range(3)] for k in (x, y, z)}
            # e_y x c = (c_z, 0, -c_x), e_z x c = (-c_y, c_x, 0), e_x x c = (0, -c_z, c_y)
            centre = [sum(E[j][k] * of[turn][k] for k in range(3)) for turn, j in ((z, 1), (x, 2), (y, 0))]
            mass = f.elements("metric").get((slides[0], slides[0]), f.graph.zero)
            found = f.graph.lift(mass * place[i] + sum(E[j][i] * x for j, x in enumerate(centre)))
            if self.vanishes(f.along_motion([found])[0] - self.linear[i]):
                return found
        return None

    def _mass(self) -> Expr | None:
        """g_aa of the first slide that moves everything the same way, or of the first floating joint."""
        f = self.f
        floating = [ball["velocities"][0] for ball in f.model.balls if len(ball["velocities"]) > TURNS]
        momenta, g = f.elements("linear_momentum"), f.elements("metric")
        for a, joint in enumerate(f.model.joints):
            columns = [momenta[a, i] for i in range(3) if (a, i) in momenta]
            if joint == "P" and columns and all(self.constant(x) is not None for x in columns) and (a, a) in g:
                return self.constant(g[a, a])
        at = f.model.coordinates.index(floating[0]) if floating else -1
        return self.constant(g[at, at]) if (at, at) in g else None


def kept_axes(
    f: ModelFormulas, constant: Callable[[Expr], Expr | None], vanishes: Callable[[Expr], bool]
) -> Iterator[tuple[str, list[Expr]]]:
    """Axes of joints that keep a direction other than x, y, z in the world: coordinate and direction."""
    rotation = f.elements("rotation")
    for a, name in enumerate(f.model.coordinates):
        columns = f.elements("Omega" if f.model.joints[a] == "R" else "U")
        frame = min((k for k, b, _ in columns if b == a), default=None)
        if frame is None:
            continue
        world = (constant(_turned(f, rotation, columns, (frame, a, j))) for j in range(3))
        axis = [x for x in takewhile(lambda x: x is not None, world) if x is not None]
        if len(axis) == 3 and sum(not vanishes(x) for x in axis) > 1:
            yield name, axis


def _turned(f: ModelFormulas, rotation: Entries, columns: Entries, place: tuple[int, int, int]) -> Expr:
    """Component j in the world of column a of frame k."""
    # (R_k)_ji (column a of frame k)_i
    k, a, j = place
    pairs = [((k, j, i), (k, a, i)) for i in range(3)]
    return f.graph.sum(rotation[r] * columns[c] for r, c in pairs if r in rotation and c in columns)
