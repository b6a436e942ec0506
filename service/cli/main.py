"""The command ``substructures``: finds the command's module by its name and imports nothing else.

A command that is ``kept`` runs in a process of its own, which is started again when it is killed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module

from service import __version__, respawn

FAILURES = "service.cli.failures"


@dataclass(frozen=True)
class Command:
    """``module``: of this package; its table ADD says by name what adds the arguments of a command to its parser."""

    name: str
    module: str
    text: str
    kept: bool = False


COMMANDS = (
    Command("serve", "server", "run the service (settings also from SUBSTRUCTURES_* variables)", kept=True),
    Command("worker", "server", "compute the jobs of servers that share a PostgreSQL database"),
    Command("demo", "demo", "couple a gripper onto a Puma 560 over HTTP and compare with published numbers"),
    Command("derive", "parts", "derive and verify a definition here, without a server"),
    Command("submit", "parts", "submit a definition to a server"),
    Command("catalogue", "catalogue", "keep the parts of a server as a folder of YAML files, and read such a folder"),
    Command("versions", "versions", "list the versions of a part, or the revisions of a tree, the newest first"),
    Command("diff", "versions", "tell how two versions, or two revisions of a tree, differ"),
    Command("uses", "versions", "list what uses a part"),
    Command("publish", "versions", "make a part of a tree"),
    Command("import", "robots", "read a robot file as a definition, with a report of what became of everything in it"),
    Command("same", "robots", "tell whether two models are the same, and which body and parameter differ"),
    Command("jobs", "jobs", "submit, watch and read batch jobs"),
    Command("backup", "backup", "copy the SQLite store to a file, also while a server runs"),
    Command("restore", "backup", "put a backup in the place of the SQLite store"),
    Command("verify", "verify", "verify every part and tree of a store against its documents"),
    Command("simulate", "analysis", "simulate a tree and judge the motion by its first integrals"),
    Command("analyse", "analysis", "formulas and numbers that follow from the equations of motion"),
    Command("export", "export", "functions of a tree for other tools: C, MATLAB, Fortran, computer algebra, ..."),
    Command("openapi", "openapi", "print the OpenAPI document"),
    Command("key", "keys", "manage API keys"),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 when it succeeded, 1 when it did not, 2 when it was called wrongly."""
    words = sys.argv[1:] if arguments is None else arguments
    if arguments is None and any(each.kept and each.name == _named(words) for each in COMMANDS):
        if not respawn.is_kept():
            return respawn.keep()
        respawn.end_with_parent()
    options = parser_for(words).parse_args(words)
    command: Callable[[argparse.Namespace], int] = options.command
    try:
        return command(options)
    except KeyboardInterrupt:
        return 130
    except Exception as error:
        lines = import_module(FAILURES).told_of(error)
        if lines is None:
            raise
        for line in lines:
            print(f"substructures: {line}", file=sys.stderr)
    return 1


def parser_for(words: Sequence[str]) -> argparse.ArgumentParser:
    """The parser; only the command that is named in ``words`` has its arguments, since they may need its imports."""
    parser = argparse.ArgumentParser(prog="substructures", description="Couple stored formulas of mechanisms.")
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    named = _named(words)
    for each in COMMANDS:
        command = commands.add_parser(each.name, help=each.text, description=each.text)
        if each.name == named:
            import_module(f"service.cli.{each.module}").ADD[each.name](command)
    return parser


def _named(words: Sequence[str]) -> str | None:
    return next((word for word in words if not word.startswith("-")), None)


if __name__ == "__main__":
    sys.exit(main())
