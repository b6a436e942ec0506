"""What is told about the errors in which a command may end."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import httpx2

from service.messages.refusals import Refused
from service.settings import SettingsError
from substructures.client import ProblemError
from substructures.errors import InvalidInput, SubstructuresError

EXPECTED = (SubstructuresError, SettingsError, ProblemError, Refused)
#: by module and name, since most commands open no database
DATABASE, DRIVER = "service.database", ("sqlalchemy.exc", "DBAPIError")


def told_of(error: Exception) -> list[str] | None:
    """The lines that tell of an error; None for one that nobody expects."""
    match error:
        case InvalidInput():
            return [f"{fault.pointer or '/'}: {fault.message}" for fault in error.faults]
        case _ if DRIVER in [(kind.__module__, kind.__name__) for kind in type(error).__mro__]:
            return [f"the database refused: {import_module('service.database.connections').told(error)}"]
        case httpx2.ConnectError():
            url = error.request.url
            address = f"{url.scheme}://{url.netloc.decode()}"
            line = f"nothing answers at {address}; start it with 'substructures serve', or say --server ADDRESS"
            return [line + ("; without TLS an address begins with http://" if url.scheme == "https" else "")]
        case httpx2.HTTPError():
            return [f"no answer from the server: {error}"]
        case IsADirectoryError() if error.filename:
            return [f"{error.filename} is a folder; the name of a file is needed"]
        case NotADirectoryError() | FileExistsError() if error.filename:
            return [f"{error.filename} is a file; the name of a folder is needed"]
        case FileNotFoundError() if error.filename and not Path(str(error.filename)).parent.is_dir():
            return [f"{error.filename}: there is no folder {Path(str(error.filename)).parent}"]
        case OSError():
            return [f"{error.filename or 'error'}: {error.strerror or error}"]
        case ValueError() | OverflowError():
            return [str(error)]
    is_expected = isinstance(error, EXPECTED) or type(error).__module__.startswith(DATABASE)
    return [str(error)] if is_expected else None
