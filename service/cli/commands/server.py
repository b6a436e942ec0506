"""The commands ``serve`` and ``worker``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from service.cli.options import Store, settings
from service.cli.output import shipped
from service.http import logs
from service.server import serve as serve_with
from service.server import work

Engine = Annotated[Literal["local", "dask", "none"] | None, typer.Option(help="What computes jobs (local).")]
EngineAddress = Annotated[str | None, typer.Option(help="The scheduler of a Dask cluster, tcp://...")]
Workers = Annotated[int | None, typer.Option(help="Processes that compute jobs (one per core).")]


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on (127.0.0.1).")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on (8000).")] = None,
    processes: Annotated[int | None, typer.Option(help="Processes that answer requests (1).")] = None,
    engine: Engine = None,
    engine_address: EngineAddress = None,
    workers: Workers = None,
    folder: Annotated[Path | None, typer.Option(help="Folder of definitions that are read, and followed.")] = None,
    database: Store = None,
) -> int:
    """Run the service until it is interrupted. Settings also come from SUBSTRUCTURES_* variables."""
    logs.configure()
    given: dict[str, Any] = {
        "host": host,
        "port": port,
        "processes": processes,
        "engine": engine,
        "engine_address": engine_address,
    }
    given |= {"workers": workers, "folder": None if folder is None else str(folder), "database": database}
    with shipped() as told:
        serve_with(settings(**given), told)
    return 0


def worker(
    engine: Engine = None,
    engine_address: EngineAddress = None,
    workers: Workers = None,
    exit_when_idle: Annotated[bool, typer.Option("--exit-when-idle", help="End when all jobs have ended.")] = False,
    database: Store = None,
) -> int:
    """Compute the jobs of servers that share a PostgreSQL database, until interrupted."""
    logs.configure()
    work(settings(engine=engine, engine_address=engine_address, workers=workers, database=database), exit_when_idle)
    return 0


COMMANDS = {"serve": serve, "worker": worker}
