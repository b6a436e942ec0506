"""Options that commands share: the server or store that they talk to, and its settings."""

from __future__ import annotations

import inspect
import os
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from json import JSONDecodeError
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Concatenate, ParamSpec

import typer

from service.settings import Settings, SettingsError, from_environment
from substructures import client as clients
from substructures.client.problems import ProblemError

if TYPE_CHECKING:
    from substructures.client import Client

P = ParamSpec("P")
SERVER = "http://127.0.0.1:8000"
#: where address and keys may be kept: server = "https://...", and by address under [keys]
FILE = "substructures/client.toml"

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
    key_from: str = "--key KEY, or the variable SUBSTRUCTURES_KEY"
    is_other: bool = False

    @contextmanager
    def client(self) -> Iterator[Client]:
        """A client of the server, or of one that serves the store while the block lasts. Raises SettingsError."""
        if self.database is not None:
            if self.address not in (None, os.environ.get("SUBSTRUCTURES_SERVER")):
                raise SettingsError("give either --server or --database")
            from service.cli.own_server import serving  # noqa: PLC0415 -- of the store alone, with all that serves

            with serving(settings(database=self.database)) as client:
                yield client
            return
        known = kept()
        address = self.address or known.get("server") or SERVER
        with (
            clients.Client(address, self.key or known.get("keys", {}).get(address.rstrip("/"))) as client,
            self._advised(address),
        ):
            yield client

    @contextmanager
    def _advised(self, address: str) -> Iterator[None]:
        """Say of a key that does not do how one is given, and of an address what it should be. Raises ProblemError,
        ValueError.
        """
        try:
            yield
        except ProblemError as error:
            code = error.problem.get("code")
            if error.status == 401:
                ended = code in ("key-expired", "key-revoked")
                new = "ask whoever runs the server for a new one ('substructures key create') and " if ended else ""
                advice = f"{new}give it by {self.key_from}"
            elif error.status < 400 or (error.status == 404 and code in (None, "not-found")):
                advice = _of_no_server(address)
            else:
                raise
            detail = f"{error.problem.get('detail')}; {advice}"
            raise ProblemError(error.status, {**error.problem, "detail": detail}) from None
        except JSONDecodeError:
            raise ValueError(f"this is answered with no JSON; {_of_no_server(address)}") from None
        except import_module("httpx2").ConnectError:  # which is there where it was raised
            if not self.is_other:
                raise
            tls = "; without TLS it begins with http://" if address.startswith("https") else ""
            message = f"nothing answers at {address}: is this the URL of the other server, and does it run?{tls}"
            raise ValueError(message) from None


def _of_no_server(address: str) -> str:
    return f"'{address}' should be the address of such a server, as in {SERVER}, without a path"


def kept_in() -> Path:
    """The file with address and keys."""
    folder = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(folder) / FILE


def kept() -> Mapping[str, Any]:
    """``server`` and ``keys`` by address out of the file, if there is one. Raises SettingsError."""
    path = kept_in()
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return {}
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SettingsError(f"{path}: {error}") from None
    keys, unknown = found.get("keys", {}), sorted(found.keys() - {"server", "keys"})
    if unknown or not isinstance(keys, dict) or not all(isinstance(x, str) for x in (found.get("server", ""), *keys)):
        what = f"'{unknown[0]}' is not known" if unknown else "a text is needed"
        raise SettingsError(f'{path}: {what}; there may be server = "https://..." and keys by address under [keys]')
    return {**found, "keys": {address.rstrip("/"): key for address, key in keys.items()}}


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
