"""What commands print: tables, JSON, warnings, and a line for those who wait. Colour is for terminals alone."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.table import Table

#: columns where there is no terminal: nothing is broken or cut there
WIDE = 100_000


def console(to_errors: bool = False) -> Console:
    """As the stream is now."""
    stream = sys.stderr if to_errors else sys.stdout
    if stream.isatty():
        return Console(file=stream, highlight=False, markup=False)
    return Console(file=stream, width=WIDE, highlight=False, markup=False, soft_wrap=True)


def print_json(value: Any) -> None:
    """In lines that people can read."""
    print(json.dumps(value, indent=1, ensure_ascii=False))


def table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """A table on a terminal, elsewhere its rows in columns of the same width."""
    texts = [[str(cell) for cell in row] for row in rows]
    if sys.stdout.isatty():
        shown = Table(*columns, box=None, pad_edge=False, header_style="bold")
        for row in texts:
            shown.add_row(*row)
        console().print(shown)
        return
    widths = [max((len(row[k]) for row in texts), default=0) for k in range(len(columns))]
    for row in texts:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def tell_warnings(told: Mapping[str, Any]) -> None:
    """Print the warnings of an answer with their places, to the stream of errors."""
    for warning in told.get("warnings", ()):
        print(f"warning: {warning['pointer'] or '/'}: {warning['message']}", file=sys.stderr)


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Say on a terminal what is being done, as long as it takes."""
    if not sys.stderr.isatty():
        yield
        return
    with console(to_errors=True).status(f"{what} ..."):
        yield


def further(detail: str, more: str) -> str:
    """A message and what is to be said beside it; the message may end with a question.

    >>> further("no part 'cel'; did you mean 'cell'?", "no tree 'cel'")
    "no part 'cel'; did you mean 'cell'? no tree 'cel'"
    """
    return f"{detail}{'' if detail.endswith('?') else ';'} {more}"
