"""Options that commands share: the server or store that they talk to, and its settings."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Concatenate, ParamSpec

import typer

from service.cli.address import KEY_FROM, SERVER, at
from service.cli.output import shipped
from service.settings import Settings, SettingsError, from_environment

if TYPE_CHECKING:
    from substructures.client import Client

P = ParamSpec("P")

File = Annotated[Path, typer.Argument(help="Definition, JSON or YAML, or a robot file.", metavar="FILE")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]
OfTrees = Annotated[bool, typer.Option("--tree", help="Trees in place of parts.")]
Wait = Annotated[bool, typer.Option(help="Wait where it takes so long that it becomes a job.")]
Note = Annotated[str, typer.Option(help="Why, in words.")]
Private = Annotated[bool, typer.Option("--private", help="For the keys of its owner alone.")]
#: the option of commands that work on the store itself
Store = Annotated[
    str | None,
    typer.Option("--database", help=f"URL: sqlite:///FILE or postgresql://... ({Settings().database}).", metavar="URL"),
]

_PANEL = "Server"
_TALKING = {
    "server": typer.Option(
        "--server", envvar="SUBSTRUCTURES_SERVER", help=f"Address ({SERVER}).", metavar="URL", rich_help_panel=_PANEL
    ),
    "key": typer.Option("--key", envvar="SUBSTRUCTURES_KEY", help="API key.", metavar="KEY", rich_help_panel=_PANEL),
    "database": typer.Option(
        "--database",
        help="In place of a server: the store itself, sqlite:///FILE or postgresql://...",
        metavar="URL",
        rich_help_panel=_PANEL,
    ),
}


@dataclass(frozen=True)
class Server:
    """Who is talked to: a server by its address and key, or a store; ``is_other``: the second one of a command."""

    address: str | None = None
    key: str | None = None
    database: str | None = None
    key_from: str = KEY_FROM
    is_other: bool = False

    @contextmanager
    def client(self) -> Iterator[Client]:
        """A client of the server, or of one that serves the store while the block lasts. Raises SettingsError."""
        if self.database is not None:
            if self.address not in (None, os.environ.get("SUBSTRUCTURES_SERVER")):
                raise SettingsError("give either --server or --database")
            found = _serving(settings(database=self.database))
        else:
            found = at(self.address, self.key, self.key_from, self.is_other)
        with found as client:
            yield client


@contextmanager
def _serving(of_store: Settings) -> Iterator[Client]:
    """A client of a store, which is served to this process alone. Raises DatabaseError, MigrationError."""
    from service.server import background  # noqa: PLC0415 -- with all that serves: few commands need it
    from service.store.keys import lent  # noqa: PLC0415 -- with the database
    from substructures.client import Client  # noqa: PLC0415 -- as for a server

    with ExitStack() as opened:
        with shipped() as told:
            address = opened.enter_context(background(of_store, told))
        key = opened.enter_context(lent(of_store.database))
        yield opened.enter_context(Client(address, key))


def with_server(run: Callable[Concatenate[Server, P], int]) -> Callable[..., int]:
    """A command that talks to a server: in place of its first parameter it has the options that say to which one."""
    own = list(inspect.signature(run, eval_str=True).parameters.values())[1:]

    @with_parameters(own, {name: Annotated[str | None, each] for name, each in _TALKING.items()})
    @wraps(run)
    def called(*given: Any, server: str | None, key: str | None, database: str | None, **options: Any) -> int:
        """The command with a Server."""
        return run(Server(server, key, database), *given, **options)

    return called


def with_more(more: Mapping[str, Any]) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Options of a table for a command with ``**options``; each None by default."""

    def extended(run: Callable[..., int]) -> Callable[..., int]:
        """The command with these, too."""
        found = inspect.signature(run, eval_str=True).parameters.values()
        return with_parameters([each for each in found if each.kind != each.VAR_KEYWORD], more)(run)

    return extended


def with_parameters(
    own: Sequence[inspect.Parameter], more: Mapping[str, Any]
) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Let a function say that it has these parameters, and ``more`` by name with their annotations, None by default."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    added = [inspect.Parameter(name, keyword, default=None, annotation=x) for name, x in more.items()]

    def told(run: Callable[..., int]) -> Callable[..., int]:
        """What is read from it are the signature and the annotations."""
        run.__signature__ = inspect.Signature([*own, *added])  # type: ignore[attr-defined] # of functions
        run.__annotations__ = {each.name: each.annotation for each in (*own, *added)}
        return run

    return told


def settings(**given: object) -> Settings:
    """Settings from the environment, with those of the command line in their place. Raises SettingsError."""
    return from_environment(os.environ, **given)
