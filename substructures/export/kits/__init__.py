"""What stands beside functions in a zip: a README, a build file, and an example of ten lines that the README prints."""

from __future__ import annotations

from substructures.export.kits.kit import KITS, kit

__all__ = ["KITS", "kit"]
