"""The command ``openapi``."""

from __future__ import annotations

import argparse
import sys

from service.app import bare_app
from service.cli.options import Add
from service.http import openapi


def _add_openapi(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_openapi)


def _openapi(_: argparse.Namespace) -> int:
    sys.stdout.write(openapi.text(bare_app()))
    return 0


ADD: Add = {"openapi": _add_openapi}
