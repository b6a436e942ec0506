"""The command ``substructures``: finds the command's module by its name and imports nothing else.

A command that is ``kept`` runs in a process of its own, which is started again when it is killed.
"""

from __future__ import annotations

import gc
import io
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

import service
from substructures.late import Table

PROGRAM = "substructures"
FAILURES, RESPAWN = "service.cli.failures", "service.processes.parent"


@dataclass(frozen=True)
class Command:
    """``module``: of :mod:`service.cli.commands`; its table COMMANDS has by name a function, or for a group functions
    by name; what they take are their parameters, what they say of themselves is their help, what they return the exit
    code.
    """

    name: str
    module: str
    text: str
    panel: str
    kept: bool = False


PARTS, TREES, SHARING, SERVICE, FILES = "Parts", "Trees", "Between people and servers", "The service", "Files"
COMMANDS = (
    Command("list", "lists", "list parts, or trees", PARTS),
    Command("search", "lists", "find parts, or trees; typing errors are forgiven", PARTS),
    Command("show", "show", "show a part, a tree, a formula, or a drawing of its structure", PARTS),
    Command("derive", "derive", "derive and verify a definition here, without a server", PARTS),
    Command("submit", "submit", "submit a definition to a server", PARTS),
    Command("versions", "versions", "list the versions of a part, or the revisions of a tree, the newest first", PARTS),
    Command("diff", "versions", "tell how two versions, or two revisions of a tree, differ", PARTS),
    Command("uses", "versions", "list what uses a part", PARTS),
    Command("withdraw", "versions", "withdraw a version of a part; what uses it goes on and is told", PARTS),
    Command("tree", "trees", "make a tree of a document, or begin one with a first part", TREES),
    Command("couple", "trees", "couple a part onto a tree, which makes a new revision", TREES),
    Command("rm", "trees", "remove trees with all their revisions", TREES),
    Command("evaluate", "evaluate", "numbers at a state: metric, christoffel, forces, ...", TREES),
    Command("simulate", "simulate", "simulate a tree and judge the motion by its first integrals", TREES),
    Command("analyse", "analyse", "formulas and numbers that follow from the equations of motion", TREES),
    Command("publish", "versions", "make a part of a tree", TREES),
    Command("sweep", "sweeps", "a table of all combinations of parts and numbers", TREES),
    Command("jobs", "jobs", "submit, watch and read batch jobs", TREES),
    Command("export", "export", "functions of a tree for other tools: C, MATLAB, Fortran, FMU, ...", FILES),
    Command("import", "robots", "read a robot file as a definition, with a report", FILES),
    Command("same", "robots", "tell whether two models are the same, and where they differ", FILES),
    Command("catalogue", "catalogue", "the parts of a server as a folder of YAML files, and back", SHARING),
    Command("pull", "exchange", "copy parts of another server to this one, verified", SHARING),
    Command("push", "exchange", "copy parts of this server to another one", SHARING),
    Command("bundle", "exchange", "parts with their formulas and certificates as one file, and back", SHARING),
    Command("mirror", "exchange", "copy all public parts of another server, as a job", SHARING),
    Command("serve", "server", "run the service (settings also from SUBSTRUCTURES_* variables)", SERVICE, kept=True),
    Command("worker", "server", "compute the jobs of servers that share a PostgreSQL database", SERVICE),
    Command("demo", "demo", "couple a gripper onto a Puma 560 over HTTP and compare with published numbers", SERVICE),
    Command("key", "keys", "manage API keys", SERVICE),
    Command("verify", "verify", "prove every part and tree of a store by deriving it anew", SERVICE),
    Command("upgrade", "upgrade", "derive a store anew with today's software", SERVICE),
    Command("backup", "backup", "copy the SQLite store to a file, also while a server runs", SERVICE),
    Command("restore", "backup", "put a backup in the place of the SQLite store", SERVICE),
    Command("doctor", "doctor", "say what is installed, what is where, and what is wrong", SERVICE),
    Command("openapi", "openapi", "print the OpenAPI document", SERVICE),
)  # fmt: skip
_BY_NAME = {command.name: command for command in COMMANDS}
_FUNCTIONS: Table[Any] = Table("COMMANDS", {each.name: f"service.cli.commands.{each.module}" for each in COMMANDS})


class _Group(TyperGroup):
    """Commands, before whose names stand no options but its own."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The arguments; of an option that is one of commands it is said where it stands."""
        try:
            return super().parse_args(ctx, list(args))
        except Exception as error:
            option = getattr(error, "option_name", "")
            found = next((path for path in self.having(option, args)), None) if option else None
            if found:
                place = f"{ctx.command_path} {found} {option}"
                ctx.fail(f"No such option: {option} before the command; it stands behind: {place}")
            raise

    def having(self, option: str, words: Sequence[str]) -> Iterator[str]:
        """The commands with an option, first those that are among some words."""
        for name in _first(self.commands, words):
            yield from _having(self.commands[name], name, option, words)


class _Commands(_Group):
    """Commands whose modules are imported when they are called; of the others help has the name and the text."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 -- of the base class
        """In the order of the table."""
        return list(_BY_NAME)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002 -- of the base class
        """The name and the text."""
        found = _BY_NAME.get(cmd_name)
        if found is None:
            return None
        return TyperCommand(found.name, help=found.text, short_help=found.text, rich_help_panel=found.panel)

    def having(self, option: str, words: Sequence[str]) -> Iterator[str]:
        """As those of a group; they are imported for it."""
        for name in _first(_BY_NAME, words):
            yield from _having(loaded(name), name, option, words)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command itself."""
        if args and not args[0].startswith("-") and args[0] not in _BY_NAME:
            from substructures.errors import meant  # noqa: PLC0415 -- of mistakes alone

            ctx.fail(f"No such command '{args[0]}'{meant(args[0], _BY_NAME)}")
        name, stub, rest = super().resolve_command(ctx, args)
        return name, stub if name is None else loaded(name), rest


def _first(names: Iterable[str], words: Sequence[str]) -> list[str]:
    """First those that are among some words, in their order."""
    return sorted(names, key=lambda name: words.index(name) if name in words else len(words))


def _having(command: Any, name: str, option: str, words: Sequence[str]) -> Iterator[str]:
    if isinstance(command, _Group):
        yield from (f"{name} {each}" for each in command.having(option, words))
    elif any(option in each.opts for each in command.params):
        yield name


class _Ended(TyperCommand):
    """A command whose function returns its exit code."""

    def invoke(self, ctx: Any) -> Any:
        """Run the function."""
        code = super().invoke(ctx)
        if code:
            raise typer.Exit(code)


def loaded(name: str) -> Any:
    """A command, or a group of them, with its arguments."""
    command = _BY_NAME[name]
    gc.disable()  # what a module defines stays: nothing to collect in a tenth of the time that it takes to start
    try:
        found = _FUNCTIONS[name]
        gc.freeze()  # nor to be looked at whenever there is something to collect
    finally:
        gc.enable()
    group = typer.Typer(cls=_Group, add_completion=False, no_args_is_help=True, help=command.text)
    if isinstance(found, Mapping):
        group.callback()(_group)
        for action, function in found.items():
            group.command(action, cls=_Ended)(function)
    else:
        group.command(name, cls=_Ended)(found)
    result = typer.main.get_command(group)
    result.name = name
    return result


def _group() -> None:
    pass


def _version(is_wanted: bool) -> None:
    if is_wanted:
        print(service.__version__)
        raise typer.Exit


def _begin(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Couple stored formulas of mechanisms."""


def app() -> Any:
    """All commands as one."""
    commands = typer.Typer(
        cls=_Commands, no_args_is_help=True, context_settings={"help_option_names": ["-h", "--help"]}
    )
    commands.callback()(_begin)
    return typer.main.get_command(commands)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 when it succeeded, 1 when it did not, 2 when it was called wrongly."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if arguments is None:
        _encode(sys.stdout)
    if arguments is None and any(each.kept and each.name == _named(words) for each in COMMANDS):
        if not {"-h", "--help"}.isdisjoint(words):
            pass  # nothing is to be kept
        elif not (respawn := import_module(RESPAWN)).is_kept():
            kept: int = respawn.keep()
            return kept
        else:
            respawn.end_with_parent()
    try:
        app().main(args=words, prog_name=PROGRAM)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except KeyboardInterrupt:
        return 130
    except Exception as error:
        lines = import_module(FAILURES).told_of(error)
        if lines is None:
            raise
        for line in lines:
            print(f"{PROGRAM}: {line}", file=sys.stderr)
        return 1
    return 0


def _encode(stream: Any) -> None:
    """Let files and pipes have UTF-8, which all that reads them expects, and terminals what they can show."""
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(encoding=None if stream.isatty() else "utf-8", errors="backslashreplace")


def _named(words: Sequence[str]) -> str | None:
    return next((word for word in words if not word.startswith("-")), None)


if __name__ == "__main__":
    # tracebacks are of use to those who write programs, and their text is plain
    os.environ.setdefault("TYPER_STANDARD_TRACEBACK", "1")
    sys.exit(main())
