"""Patterns of texts, and what is said of one that does not match; other modules add theirs."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable

NAME = r"^[A-Za-z][A-Za-z0-9_]{0,63}$"
LIBRARY_NAME = r"^[a-z0-9][a-z0-9-]{0,63}$"
TAG = r"^[a-z0-9][a-z0-9-]{0,31}$"
#: by pattern, what is said about a text that does not match it
PATTERNS: dict[str, Callable[[str], str]] = {}


def _suggested(text: str, wrong: str, filling: str, most: int = 64) -> str:
    """The text as a name, where that can be had by small changes."""
    plain = "".join(c for c in unicodedata.normalize("NFKD", text.strip()) if not unicodedata.combining(c))
    name = re.sub(wrong, filling, plain).strip(filling)[:most]
    return f"; for example '{name}'" if name and name[0].isascii() and name[0].isalnum() else ""


PATTERNS[NAME] = lambda text: (
    "a name is a letter and up to 63 letters, digits and '_'"
    + _suggested(re.sub(r"^[^A-Za-z]+", "", text), r"[^A-Za-z0-9_]+", "_")
)
PATTERNS[LIBRARY_NAME] = lambda text: (
    "a name here is up to 64 of a to z, 0 to 9 and '-', the first no '-'"
    + _suggested(text.lower(), r"[^a-z0-9-]+", "-")
)
PATTERNS[TAG] = lambda text: (
    "a tag is up to 32 of a to z, 0 to 9 and '-', the first no '-'" + _suggested(text.lower(), r"[^a-z0-9-]+", "-", 32)
)
