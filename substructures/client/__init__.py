"""A client of the HTTP interface, for Python programs; it knows nothing of how the service is made."""

from substructures.client.client import Client, ProblemError, ServerLost
from substructures.formats.packing import unpack

__all__ = ["Client", "ProblemError", "ServerLost", "unpack"]
