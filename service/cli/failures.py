"""What is told about the errors in which a command may end."""

from __future__ import annotations

from pathlib import Path

import httpx2
from sqlalchemy.exc import DBAPIError

from service.database.connections import DatabaseError, told
from service.database.schema import MigrationError
from service.refusals import Refused
from service.settings import SettingsError
from substructures.client import ProblemError
from substructures.errors import InvalidInput, SubstructuresError

EXPECTED = (SubstructuresError, SettingsError, DatabaseError, MigrationError, ProblemError, Refused)


def told_of(error: Exception) -> list[str] | None:
    """The lines that tell of an error; None for one that nobody expects."""
    match error:
        case InvalidInput():
            return [f"{fault.pointer or '/'}: {fault.message}" for fault in error.faults]
        case DBAPIError():
            return [f"the database refused: {told(error)}"]
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
    return [str(error)] if isinstance(error, EXPECTED) else None
