"""What commands print: tables, JSON, warnings, and a line for those who wait. Colour is for terminals alone."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from importlib import import_module
from time import monotonic
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console
    from rich.status import Status

#: modules of terminals alone
CONSOLE, TABLE = "rich.console", "rich.table"
#: columns where there is no terminal: nothing is broken or cut there
WIDE = 100_000
QUICK = 1.0  # seconds for which nobody is told what is done
#: lines for those who wait, as they are now on the terminal
_shown: list[Status] = []


def console(to_errors: bool = False) -> Console:
    """As the stream is now."""
    stream = sys.stderr if to_errors else sys.stdout
    more = {} if stream.isatty() else {"width": WIDE, "soft_wrap": True}
    made: Console = import_module(CONSOLE).Console(file=stream, highlight=False, markup=False, **more)
    return made


def print_json(value: Any) -> None:
    """In lines that people can read."""
    print(json.dumps(value, indent=1, ensure_ascii=False))


def table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """A table on a terminal, elsewhere its rows in columns of the same width."""
    texts = [[str(cell) for cell in row] for row in rows]
    if sys.stdout.isatty():
        shown = import_module(TABLE).Table(*columns, box=None, pad_edge=False, header_style="bold")
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
    with console(to_errors=True).status(f"{what} ...") as status:
        _shown.append(status)
        try:
            yield
        finally:
            _shown.remove(status)


@contextmanager
def counting(what: str) -> Iterator[Callable[[int, int], None]]:
    """Give what is told how many of all are done. It says so from the first second on: on a terminal over and over, in
    the line of who waits already if there is one; elsewhere once.
    """
    begun, is_said = monotonic(), False
    with ExitStack() as own:

        def told(done: int, of: int) -> None:
            """Show it, unless it was quick or is over."""
            nonlocal is_said
            if done == of:
                own.close()
            elif monotonic() - begun >= QUICK:
                if not sys.stderr.isatty():
                    if not is_said:
                        print(f"{what}: {done} of {of} ...", file=sys.stderr, flush=True)
                elif _shown:
                    _shown[-1].update(f"{what}: {done} of {of} ...")
                else:
                    own.enter_context(waiting(f"{what}: {done} of {of}"))
                is_said = True

        yield told


def shipped() -> AbstractContextManager[Callable[[int, int], None]]:
    """What tells of the first start of a store."""
    return counting("first start, the shipped catalogue is derived and stored")


def further(detail: str, more: str) -> str:
    """A message and what is to be said beside it; the message may end with a question.

    >>> further("no part 'cel'; did you mean 'cell'?", "no tree 'cel'")
    "no part 'cel'; did you mean 'cell'? no tree 'cel'"
    """
    return f"{detail}{'' if detail.endswith('?') else ';'} {more}"
