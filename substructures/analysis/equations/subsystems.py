"""Subsystems that do not mix: blocks of coordinates, each with an energy of its own (notation.md, section 7).

Coordinates are of one block where g_ab joins them, where g_ab or a force Q_a of one depends on the other, and where one
closure or velocity constraint holds both. Then g' and Q of a block know nothing of the rest, and with V_B, V where all
others are 0,

    H_B = 1/2 sum over B of p_a q'^a + V_B,        H_B' = sum over B of Q_a q'^a + V_B'
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator

from substructures.analysis.equations.energy import EnergyRule, depends_on, rule_of
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.integral import Integral
from substructures.errors import listed
from substructures.expr.graph import Expr
from substructures.expr.walk import reachable, transfer


def subsystems(
    f: ModelFormulas, vanishes: Callable[[Expr], bool], given: Collection[str]
) -> Iterator[tuple[Integral, Expr]]:
    """H_B [J] of all blocks where it is constant or falls; none where everything is one block. ``given``: inputs that
    vary.
    """
    blocks = _blocks(f)
    for block in blocks if len(blocks) > 1 else ():
        own = {f.model.coordinates[a] for a in block}
        moving = {name for ball in f.model.balls if ball["velocities"][0] in own for name in ball["positions"]}
        rest = [name for name in f.model.positions if name not in own | moving]
        potential = _alone(f, rest)
        if potential is None or depends_on([potential], given):
            continue
        forces = f.vector("forces")
        power = f.graph.sum(forces[a] * f.rates[a] for a in block) + f.along_motion([potential])[0]
        rule = rule_of(f, power, vanishes)
        if rule != "balance":
            twice = f.graph.sum(f.momenta[a] * f.rates[a] for a in block)
            yield _integral(tuple(f.model.coordinates[a] for a in block), rule), twice / 2 + potential


def _integral(names: tuple[str, ...], rule: EnergyRule) -> Integral:
    told = listed(f"'{name}'" for name in names)
    forces = "have a potential" if rule == "constant" else "without potential are linear in the velocities"
    reason = f"neither inertia nor forces join {told} with other coordinates, and the forces on these {forces}"
    return Integral(f"energy.{names[0]}", "subsystem", rule, "J", reason, coordinates=names)


def _alone(f: ModelFormulas, rest: Iterable[str]) -> Expr | None:
    """V where all other coordinates are 0; None where it has no value there."""
    try:
        return transfer([f.scalar("potential_energy")], f.graph, f.at_zero(rest))[0]
    except (ZeroDivisionError, ValueError):
        return None


def _blocks(f: ModelFormulas) -> list[list[int]]:
    """Coordinates that mix, in order."""
    block = {a: {a} for a in range(f.n)}
    for some in _mixed(f):
        first, *others = some
        for other in others:
            if block[other] is not block[first]:
                joined = block[first] | block[other]
                block |= dict.fromkeys(joined, joined)
        if len(block[first]) == f.n:
            break
    return [sorted(b) for a, b in block.items() if a == min(b)]


def _mixed(f: ModelFormulas) -> Iterator[list[int]]:
    """Coordinates that stand in one formula of the equations of motion."""
    place = {str(x.value): a for some in (f.q, f.rates) for a, x in enumerate(some)}
    for ball in f.model.balls:
        own = [place[name] for name in ball["velocities"]]
        place |= dict.fromkeys(ball["positions"], own[0])
        yield own

    def within(x: Expr) -> set[int]:
        """The coordinates that it names, or whose rate."""
        return {place[str(n.value)] for n in reachable([x]) if n.op == "sym" and str(n.value) in place}

    yield from map(list, f.elements("metric"))  # where these join all, nothing else is looked at
    for (a, _), x in f.elements("metric").items():
        yield [a, *within(x)]
    for a, x in enumerate(f.vector("forces")):
        yield [a, *within(x)]
    rows: dict[int, set[int]] = {}
    for (k, a), x in f.constraint_rows.items():
        rows[k] = rows.get(k, set()) | {a} | within(x)
    yield from map(sorted, rows.values())
