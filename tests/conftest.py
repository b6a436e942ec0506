"""Test helpers in this directory (random_trees, random_cuts, independent) can be imported by every test."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
