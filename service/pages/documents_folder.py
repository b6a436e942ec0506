"""Where the documents are that pages show."""

from __future__ import annotations

from pathlib import Path

#: beside the package in a clone, in it where it was installed
_BESIDE, _INSIDE = Path(__file__).parents[2] / "docs", Path(__file__).with_name("docs")
FOLDER = _INSIDE if _INSIDE.is_dir() else _BESIDE
