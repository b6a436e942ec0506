"""What the shell offers for arguments: names of parts and trees that the server knows, and words out of a list."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import typer

from service.cli.address import at
from substructures.client.steps import step

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


def jobs(ctx: typer.Context, incomplete: str) -> list[str]:
    """Ids of jobs, the newest first."""
    found = [str(item["id"]) for item in _told(ctx, "jobs", page_size=MOST).get("items", ())]
    return [job for job in found if job.startswith(incomplete)]


def formulas(ctx: typer.Context, incomplete: str) -> list[str]:
    """Quantities of which the part or tree that is shown has formulas."""
    kinds = ("trees",) if ctx.params.get("tree") else ("substructures", "trees")
    return _formulas(ctx, incomplete, _first(ctx, "name"), kinds)


def exported(ctx: typer.Context, incomplete: str) -> list[str]:
    """Quantities of the tree, or behind ``--part`` the part, that is exported."""
    return _formulas(ctx, incomplete, _first(ctx, "tree"), ("substructures" if ctx.params.get("part") else "trees",))


def _formulas(ctx: typer.Context, incomplete: str, name: str, kinds: Iterable[str]) -> list[str]:
    found = next((told["operations"] for kind in kinds if "operations" in (told := _told(ctx, kind, name))), ())
    return listed(name for name in found if name != "total")(incomplete)


def listed(known: Iterable[str]) -> Callable[[str], list[str]]:
    """What offers the words of a list, of which several are between commas."""
    words_ = tuple(known)

    def offered(incomplete: str) -> list[str]:
        """The line with each word that its last one may become."""
        before, comma, last = incomplete.rpartition(",")
        return [f"{before}{comma}{word}" for word in words_ if word.startswith(last)]

    return offered


def places(ctx: typer.Context, incomplete: str) -> list[str]:
    """Where something can be mounted on the tree that is named; behind the name of a port and ``=``, too."""
    before, sign, last = incomplete.rpartition("=")
    found = _told(ctx, "trees", _first(ctx, "tree")).get("frames", ())
    return [f"{before}{sign}{place}" for place in ("world", *found) if place.startswith(last)]


def ports(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of ports of parts."""
    found = {port for item in _told(ctx, "substructures", page_size=MOST).get("items", ()) for port in item["ports"]}
    return sorted(port for port in found if port.startswith(incomplete))


def _names(ctx: typer.Context, incomplete: str, kind: str) -> list[str]:
    wanted: dict[str, Any] = {"page_size": MOST, **({"q": incomplete} if incomplete else {})}
    names = [str(item["name"]) for item in _told(ctx, kind, **wanted).get("items", ())]
    return sorted(name for name in names if name.startswith(incomplete))


def _first(ctx: typer.Context, argument: str) -> str:
    """The first argument, which is not yet known by its name before the value of an option."""
    given = ctx.params.get(argument) or next(iter(ctx.args), "")
    return given if isinstance(given, str) else ""


def _told(ctx: typer.Context, kind: str, name: str | None = None, **wanted: Any) -> dict[str, Any]:
    """What a server says; nothing where there is none, or none that answers at once. A store is not served for it."""
    if ctx.params.get("database"):
        return {}
    try:
        with at(ctx.params.get("server"), ctx.params.get("key")) as client:
            path = f"/v1/{kind}" if name is None else f"/v1/{kind}/{step(name)}"
            answer = client.request("GET", path, params=wanted, retries=0, timeout=SECONDS)
            return dict(answer.json())
    except Exception:  # whatever hinders it: there is nothing to offer
        return {}
