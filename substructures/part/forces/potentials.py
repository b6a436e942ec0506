"""The potential energy of what acts between the bodies of a part (notation.md, section 7).

Springs have theirs in closed form. Forces that are given as formulas have the potential that is found by integration:
V with d_a V = -Q_a exactly, of as much of them as has one, and V = 0 where all coordinates are 0. Looked at is the
force at rest without inputs, less the terms of the sum, as it is written, that depend on the time: all else is a force
without potential, and so is what is no gradient.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.errors import TooLarge
from substructures.expr.calculus.integrate import LIMIT, filtered, from_zero, needed, potential, symbols_of
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr
from substructures.expr.rings.expand import is_zero
from substructures.expr.walk import transfer
from substructures.loads.names import LEFT_OUT
from substructures.loads.scope import Scope
from substructures.part.forces.load_names import velocity_in


def spring_potential(scope: Scope, names: Sequence[str], forces: Mapping[int, Expr], pointer: str) -> Expr:
    """The potential of one spring whose stiffness or length depends on the state; zero, with a notice, where there is
    none: with a velocity in it, or where none is found.
    """
    found = None
    if velocity_in(names, forces.values()) is None:
        found = potential([forces.get(a, scope.graph.zero) for a in range(len(names))], names)
    if found is None:
        message = "the force of this spring depends on the state, and no potential of it was found"
        scope.notices.append({"pointer": pointer, "code": "no-potential", "message": f"{message}: {LEFT_OUT}"})
    return scope.graph.zero if found is None else from_zero(found, names)


def found_potential(scope: Scope, names: Sequence[str], forces: Sequence[Sequence[Expr]]) -> Expr:
    """V [J], d_a V = -Q_a, of as much of the forces (n,) on the coordinates, terms of a sum each, as has one.

    Of forces that depend on each other's coordinates either all of them count, or what each has of its own alone.
    """
    fixed = frozenset(s.name for s in scope.symbols.values() if s.kind == "parameter")
    held = [_at_rest(scope, terms, fixed.union(names)) for terms in forces]
    result = scope.graph.zero
    for group in _groups(held, names):
        whole = potential([held[a] for a in group], [names[a] for a in group])
        result = result + (_own(scope, names, held, group, fixed) if whole is None else whole)
        if whole is None:
            on = ", ".join(f"'{names[a]}'" for a in group if not held[a].is_zero)
            message = f"no potential was found of all forces of joints and loads on {on}"
            scope.notices.append({"pointer": "/loads", "code": "no-potential", "message": f"{message}: {LEFT_OUT}"})
    return from_zero(result, names)


def _at_rest(scope: Scope, terms: Sequence[Expr], steady: frozenset[str]) -> Expr:
    """What is left of a force at rest without inputs; terms that depend on the time are left out, and those without a
    value at rest.
    """
    result, zero = scope.graph.zero, scope.graph.zero
    for term in terms:
        try:
            (rest,) = transfer([term], scope.graph, dict.fromkeys(symbols_of([term]) - steady - {"t"}, zero))
            if "t" in symbols_of([rest]):
                rest = _without_time(scope, rest)
        except (TooLarge, ZeroDivisionError):
            continue
        result = result + rest
    return result


def _without_time(scope: Scope, term: Expr) -> Expr:
    """A term that names the time without depending on it, or zero. Raises TooLarge, ZeroDivisionError."""
    if not is_zero(derivative(term, "t"), LIMIT):
        return scope.graph.zero
    return transfer([term], scope.graph, {"t": scope.graph.zero})[0]


def _own(
    scope: Scope, names: Sequence[str], forces: Sequence[Expr], group: Sequence[int], fixed: frozenset[str]
) -> Expr:
    """V of the terms of every force that contain its own coordinate alone: each of them has a potential."""
    result = scope.graph.zero
    for a in group:
        alone = filtered(forces[a], fixed | {names[a]}) or scope.graph.zero
        result = result + (potential([alone], [names[a]]) or scope.graph.zero)
    return result


def _groups(forces: Sequence[Expr], names: Sequence[str]) -> list[list[int]]:
    """Coordinates on which forces act that depend on each other's, in order; those without a force are in none."""
    groups: list[tuple[set[int], set[str]]] = []
    for a, force in enumerate(forces):
        if force.is_zero:
            continue
        members, used = {a}, set(needed(force) & set(names)) | {names[a]}
        for other in [g for g in groups if g[1] & used]:
            groups.remove(other)
            members, used = members | other[0], used | other[1]
        groups.append((members, used))
    # the coordinates that are named are part of the curl, also where no force acts on them
    return [sorted(a for a, name in enumerate(names) if a in members or name in used) for members, used in groups]
