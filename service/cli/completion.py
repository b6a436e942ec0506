"""What the shell offers for arguments: names of parts and trees that the server knows, and words out of a list."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import typer

from service.cli.options import Server

SECONDS = 1.0  # that somebody waits for a server at a prompt
MOST = 200  # names that a server is asked for


def words(known: Iterable[str]) -> Callable[[str], list[str]]:
    """What offers the words of a list."""
    listed = tuple(known)
    return lambda incomplete: [word for word in listed if word.startswith(incomplete)]


def parts(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of parts."""
    return _names(ctx, incomplete, "substructures")


def trees(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of trees."""
    return _names(ctx, incomplete, "trees")


def parts_and_trees(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of both."""
    return [*parts(ctx, incomplete), *trees(ctx, incomplete)]


def parts_or_trees(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of parts, or behind ``--tree`` of trees."""
    return trees(ctx, incomplete) if ctx.params.get("tree") is True else parts(ctx, incomplete)


def _names(ctx: typer.Context, incomplete: str, kind: str) -> list[str]:
    """None where there is no server, or none that answers at once; a store is not served for it."""
    if ctx.params.get("database"):
        return []
    wanted = {"page_size": MOST, **({"q": incomplete} if incomplete else {})}
    try:
        with Server(ctx.params.get("server"), ctx.params.get("key")).client() as client:
            answer = client.request("GET", f"/v1/{kind}", params=wanted, retries=0, timeout=SECONDS)
            names = [str(item["name"]) for item in answer.json()["items"]]
    except Exception:  # whatever hinders it: there is nothing to offer
        return []
    return sorted(name for name in names if name.startswith(incomplete))
