"""Mechanisms out as URDF: all numbers bound, everything placed where all coordinates are zero."""

from __future__ import annotations

from substructures.export.urdf.document import MEDIA_TYPE, urdf_of_part, urdf_of_tree

__all__ = ["MEDIA_TYPE", "urdf_of_part", "urdf_of_tree"]
