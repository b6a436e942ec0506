"""The command ``openapi``."""

from __future__ import annotations

import sys

from service.app import bare_app
from service.http import openapi as documents


def openapi() -> int:
    """Print the OpenAPI document."""
    sys.stdout.write(documents.text(bare_app()))
    return 0


COMMANDS = {"openapi": openapi}
