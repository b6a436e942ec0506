"""In which order names are evaluated whose expressions name each other."""

from __future__ import annotations

from collections.abc import Callable, Iterable


def needed_first(name: str, named: Callable[[str], Iterable[str]]) -> list[str]:
    """All that a name needs, itself last, each once and after what it names unless that leads in a circle; however many
    there are, nothing is nested. ``named``: what the expression of a name names.

    >>> needed_first("a", {"a": "bc", "b": "c", "c": ""}.__getitem__)
    ['c', 'b', 'a']
    """
    order, open_, seen = list[str](), [(name, iter(named(name)))], {name}
    while open_:
        last, names = open_[-1]
        following = next((x for x in names if x not in seen), None)
        if following is None:
            order.append(last)
            open_.pop()
        else:
            seen.add(following)
            open_.append((following, iter(named(following))))
    return order
