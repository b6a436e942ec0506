"""The application: routes and conventions around a store."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from fastapi import FastAPI
from sqlalchemy.exc import DBAPIError

from service import __version__
from service.database.connections import Database, DatabaseError, told
from service.http import openapi, problems
from service.http.compression import Compression
from service.http.middleware import Conventions
from service.http.not_derived import DerivesFirst
from service.http.routing import Operation
from service.jobs.engines.pool import InProcess
from service.metrics import Metrics
from service.operations.seed import Told, import_catalogue
from service.pages import account, documents
from service.pages import routes as pages
from service.pages.errors import error_page
from service.pages.model import assets
from service.pages.model import routes as model_pages
from service.processes.parent import Kept
from service.queries import idempotency
from service.routes import (
    aliases,
    analyses,
    audit,
    bundles,
    differences,
    equivalences,
    formulas,
    imports,
    models,
    pictures,
    publishing,
    reports,
    substructures,
    system,
    trees,
    versions,
    visibility,
)
from service.routes.jobs import job_streams, jobs, tables
from service.routes.programs import exports, kernels, modules
from service.settings import Settings
from service.store.store import Store

ROUTES = (
    substructures,
    aliases,
    visibility,
    versions,
    bundles,
    differences,
    exports,
    modules,
    formulas,
    pictures,
    reports,
    trees,
    publishing,
    analyses,
    models,
    kernels,
    jobs,
    job_streams,
    tables,
    imports,
    equivalences,
    system,
    audit,
    account,
    pages,  # before the documents, whose addresses begin with one of theirs
    documents,
    assets,
    model_pages,
)
DESCRIPTION = "Stored formulas of mechanisms, coupled into equations of motion: metric, Christoffel symbols, forces."


@contextmanager
def open_store(
    settings: Settings,
    kept: Kept | None = None,
    require: Callable[[Store], None] = lambda _store: None,
    progress: Told = lambda _done, _all: None,
) -> Iterator[Store]:
    """The store of a server: claimed, migrated and with the shipped catalogue in it before anybody can ask.

    ``kept``: what this process shares with others of the server; ``require`` refuses a store before anything is stored
    in it; ``progress``: as ``told`` of :func:`import_catalogue`. Raises DatabaseError, MigrationError, and what
    ``require`` does.
    """
    kept = kept or Kept()
    database = Database(settings.database, claim=kept.claim, seal_key=settings.seal_key)
    label = str(kept.number) if settings.processes > 1 else ""
    store = Store(settings, database, Metrics(label), InProcess())
    try:
        require(store)
        if kept.number == 0:
            _prepare(store, kept.is_start or settings.processes == 1, progress)
        yield store
    finally:
        store.close()


def _prepare(store: Store, is_alone: bool, progress: Told) -> None:
    """``is_alone``: no other process of this server is at work."""
    settings, database = store.settings, store.database
    try:
        if database.is_sqlite and is_alone:  # nor of another one: whatever is in flight died with the last one
            with database.write() as connection:
                idempotency.forget(connection, timedelta(hours=settings.limits.idempotency_hours), timedelta(0))
        if settings.catalogue:
            import_catalogue(store, progress)
    except DBAPIError as error:
        raise DatabaseError(f"cannot use the database {database.url}: {told(error)}") from None


def create_app(store: Store) -> FastAPI:
    """The app that serves a store."""
    hosts = (*store.settings.allowed_hosts, store.settings.host)
    app = bare_app(tuple(host.lower() for host in hosts), store.metrics)
    app.state.store = store
    return app


def bare_app(allowed_hosts: tuple[str, ...] = (), metrics: Metrics | None = None) -> openapi.DocumentedApp:
    """Routes and conventions without a store; enough for the OpenAPI document."""
    app = openapi.DocumentedApp(
        title="substructures",
        version=__version__,
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        telemetry={"tracing": False, "metrics": False, "logs": False},  # /metrics and the log are our own
    )
    routers = [models.evaluations, *(module.router for module in ROUTES)]  # what is asked for most is looked for first
    operations = [route for router in routers for route in router.routes if isinstance(route, Operation)]
    app.router.routes += operations
    app.described = operations
    problems.install(app, operations, error_page)
    app.add_middleware(Compression)
    app.add_middleware(DerivesFirst)
    app.add_middleware(Conventions, allowed_hosts=allowed_hosts, metrics=metrics or Metrics())
    return app
