"""The shell around the science: HTTP, database and command line. Imports ``substructures``, never the reverse."""

from importlib.metadata import version

__version__ = version("substructures")
