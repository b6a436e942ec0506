"""The options that all benchmarks have, and their figures as a file."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path


def options(description: str | None, quick: str = "") -> argparse.ArgumentParser:
    """``--json FILE``, and ``--quick`` where there is a shorter run; ``quick``: what that leaves out."""
    parser = argparse.ArgumentParser(description=description)
    if quick:
        parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures to a file")
    return parser


def keep(figures: Mapping[str, float], file: Path | None) -> None:
    """Write the figures, of six digits each, where a file is named."""
    if file is not None:
        rounded = {name: float(f"{figure:.6g}") for name, figure in figures.items()}
        file.write_text(json.dumps(rounded, indent=2) + "\n")
