"""What exported files say that they were made by."""

from __future__ import annotations

from importlib.metadata import version

SOFTWARE = f"substructures {version('substructures')}"
