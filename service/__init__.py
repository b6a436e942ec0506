"""The shell around the science: HTTP, database and command line. Imports ``substructures``, never the reverse."""

from __future__ import annotations

import substructures

__all__ = ["__version__"]

__version__: str


def __getattr__(name: str) -> str:
    """The version, which is looked for when it is first asked for."""
    if name == "__version__":
        return substructures.__version__
    raise AttributeError(f"module 'service' has no attribute '{name}'")
