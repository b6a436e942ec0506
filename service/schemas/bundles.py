"""Shapes of answers about bundles, for OpenAPI."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from service.schemas.shapes import Digest, Links, Shape


class BundledView(Shape):
    """What became of a part of a bundle."""

    name: str
    version: int
    digest: Digest
    outcome: Literal["stored", "same"] = Field(description="`same`: this content was there already")
    formulas: Literal["equal", "differ"] = Field(
        description="whether those in the bundle are, by their digest, those that were derived and stored here"
    )
    links: Links


class BundleView(Shape):
    """A bundle that was imported, in its order."""

    items: list[BundledView]
