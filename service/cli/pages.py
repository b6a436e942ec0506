"""Items of a server that come in pages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import urlencode

from substructures.client import Client

SIZE = 200


def items(
    client: Client, path: str, wanted: Mapping[str, Any] | None = None, size: int = SIZE
) -> Iterator[dict[str, Any]]:
    """The items of all pages, as far as they are asked for; ``wanted``: filters, those that are None left out."""
    filters = {name: x for name, x in (wanted or {}).items() if x is not None}
    link: str | None = f"{path}?{urlencode({**filters, 'page_size': size}, doseq=True)}"
    while link is not None:
        page = client.request("GET", link).json()
        yield from page["items"]
        link = page["links"]["next"]
