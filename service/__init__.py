"""The shell around the science: HTTP, database and command line. Imports ``substructures``, never the reverse."""

from substructures import __version__

__all__ = ["__version__"]
