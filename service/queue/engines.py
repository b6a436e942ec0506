"""Which engine the settings name."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from urllib.parse import urlsplit

from service.jobs.engine import Engine
from service.jobs.local import LocalEngine
from service.jobs.pool import NICE, WorkerPool
from service.jobs.process import rights_of
from service.settings import Settings, SettingsError


def engine_of(settings: Settings) -> Callable[[], Engine] | None:
    """What makes the engine that the settings name; None: no engine. Raises SettingsError."""
    workers = settings.workers or os.cpu_count() or 1
    match settings.engine:
        case "local":
            _check_user(settings.runner_user)
            return lambda: LocalEngine(workers, settings.runner_user)
        case "dask":
            return _dask(settings.engine_address)
    return None


def worker_pool(settings: Settings, warm: bool = True) -> WorkerPool:
    """The runners of one process that answers requests: one more than it has cores, so that one is free for others.

    ``warm``: the first one is started now. Raises SettingsError.
    """
    _check_user(settings.runner_user)
    cores = -(-(os.cpu_count() or 1) // settings.processes)
    return WorkerPool(cores + 1, lambda: LocalEngine(1, settings.runner_user, NICE), warm)


def _check_user(user: str) -> None:
    """Raises SettingsError for a user whose rights we cannot give to a process."""
    if not user:
        return
    try:
        subprocess.run([sys.executable, "-I", "-c", ""], check=True, **rights_of(user))
    except (LookupError, OSError, subprocess.CalledProcessError) as error:
        raise SettingsError(f"SUBSTRUCTURES_RUNNER_USER: no process of '{user}' can be started: {error}") from None


def _dask(address: str) -> Callable[[], Engine]:
    if not _is_address(address):
        given = f", not {address!r}" if address else ""
        raise SettingsError(
            "the engine dask needs the address of its scheduler: --engine-address tcp://host:port or tls://host:port"
            + given
        )
    try:
        module = import_module("service.jobs.dask")  # an extra; it takes long to load
    except ImportError:
        raise SettingsError(
            "the engine dask needs the extra: pip install 'substructures[dask]' (in a clone: pip install -e '.[dask]')"
        ) from None
    return lambda: module.DaskEngine(address)


def _is_address(text: str) -> bool:
    try:
        parts = urlsplit(text)
        expected = f"{parts.scheme}://{parts.netloc}"
        is_plain = text == expected and "@" not in text and not any(letter.isspace() for letter in text)
        return is_plain and parts.scheme in ("tcp", "tls") and bool(parts.hostname) and bool(parts.port)
    except ValueError:
        return False
