"""A server by its address and a key, which may be kept in a file."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from json import JSONDecodeError
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.settings import SettingsError
from substructures import client as clients
from substructures.client.problems import ProblemError

if TYPE_CHECKING:
    from substructures.client import Client

SERVER = "http://127.0.0.1:8000"
#: where address and keys may be kept: server = "https://...", and by address under [keys]
FILE = "substructures/client.toml"
KEY_FROM = "--key KEY, or the variable SUBSTRUCTURES_KEY"


@contextmanager
def at(address: str | None, key: str | None, key_from: str = KEY_FROM, is_other: bool = False) -> Iterator[Client]:
    """A client of the server at an address, by default the one that is kept; ``key_from``: how a key is given;
    ``is_other``: the second server of a command. Raises SettingsError, ProblemError, ValueError.
    """
    known = kept()
    address = address or known.get("server") or SERVER
    with (
        clients.Client(address, key or known.get("keys", {}).get(address.rstrip("/"))) as client,
        _advised(address, key_from, is_other),
    ):
        yield client


@contextmanager
def _advised(address: str, key_from: str, is_other: bool) -> Iterator[None]:
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
            advice = f"{new}give it by {key_from}"
        elif error.status < 400 or (error.status == 404 and code in (None, "not-found")):
            advice = _of_no_server(address)
        else:
            raise
        detail = f"{error.problem.get('detail')}; {advice}"
        raise ProblemError(error.status, {**error.problem, "detail": detail}) from None
    except JSONDecodeError:
        raise ValueError(f"this is answered with no JSON; {_of_no_server(address)}") from None
    except import_module("httpx2").ConnectError:  # which is there where it was raised
        if not is_other:
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
