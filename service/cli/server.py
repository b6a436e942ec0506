"""The commands ``serve`` and ``worker``."""

from __future__ import annotations

import argparse

from service import logs
from service.cli.options import Add, add_database, settings_of
from service.server import serve, work


def _add_serve(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_serve)
    command.add_argument("--host", help="address to listen on (127.0.0.1)")
    command.add_argument("--port", type=int, help="port to listen on (8000)")
    command.add_argument("--processes", type=int, help="processes that answer requests (1)")
    _add_engine(command)
    add_database(command)


def _add_worker(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_worker)
    _add_engine(command)
    add_database(command)


def _add_engine(command: argparse.ArgumentParser) -> None:
    command.add_argument("--engine", choices=("local", "dask", "none"), help="what computes jobs (local)")
    command.add_argument("--engine-address", help="the scheduler of a Dask cluster, tcp://...")
    command.add_argument("--workers", type=int, help="processes that compute jobs (one per core)")


def _serve(options: argparse.Namespace) -> int:
    logs.configure()
    serve(settings_of(options))
    return 0


def _worker(options: argparse.Namespace) -> int:
    logs.configure()
    work(settings_of(options))
    return 0


ADD: Add = {"serve": _add_serve, "worker": _add_worker}
