"""Connections: one writer and a pool of readers on SQLite, one pool on PostgreSQL; transactions as context managers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from shutil import disk_usage
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError

from service.database.clock import set_by
from service.database.file import Claim, DatabaseError, Watch, require_store
from service.database.schema import is_newest
from service.database.seal_keys import key_beside, key_in
from service.database.seals import KEY

READERS = 16
BUSY_MS = 10_000
IDLE_MS = 10_000  # after which PostgreSQL ends a write transaction of a process that was stopped in the middle of it
#: seconds, but for the last: both ends of a connection to PostgreSQL notice a peer that is gone after some 20 s
TCP = {"keepalives_idle": 5, "keepalives_interval": 5, "keepalives_count": 3, "tcp_user_timeout": 20_000}
CONNECT_SECONDS = 10

ROOM = 2**20  # bytes
STANDBY = "SELECT pg_is_in_recovery()"  # of PostgreSQL

__all__ = ["Connection", "DBAPIError", "Database", "DatabaseError", "normalised", "told"]


class Database:
    """The store. Use ``read()`` and ``write()``; a ``write()`` commits as a whole or not at all."""

    def __init__(self, address: str, *, exclusive: bool = True, claim: int | None = None, seal_key: str = "") -> None:
        """Open and migrate the database at an SQLAlchemy URL.

        ``exclusive`` claims an SQLite file for this server, and makes one; without, it has to be there. ``claim``: the
        descriptor of a claim that another of its processes has made, known as ``self.claim`` here. ``seal_key``: the
        file of the key of its seals, if not that beside an SQLite file. Raises DatabaseError when there is no database
        or key, when another server holds it, when it is damaged, when it does not answer and for an unknown kind of
        URL or file, MigrationError for a store of a newer version.
        """
        self.url = normalised(address)
        self.claim: int | None = None
        self._watch: Watch | None = None
        with ExitStack() as opened:
            if self.is_sqlite and self.file.exists():
                require_store(self.file)
            elif self.is_sqlite and not exclusive:
                raise DatabaseError(f"there is no database {self.file}; 'substructures serve' makes one")
            if exclusive and self.is_sqlite:
                claimed = opened.enter_context(closing(Claim(self.file, claim)))
                self.claim = claimed.shared
                self._watch = opened.enter_context(closing(Watch(claimed.path)))
            key = key_in(Path(seal_key)) if seal_key else key_beside(self.file) if self.is_sqlite else b""
            self.writer = _engine(self.url, key, writer=True)
            opened.callback(self.writer.dispose)
            self.reader = _engine(self.url, key, writer=False) if self.is_sqlite else _snapshots(self.writer)
            opened.callback(self.reader.dispose)
            try:
                if not is_newest(self.writer):
                    import_module("service.database.migrate").upgrade(self.writer)
            except DBAPIError as error:
                raise DatabaseError(f"cannot use the database {self.url}: {told(error)}") from None
            self._opened = opened.pop_all()

    @property
    def is_sqlite(self) -> bool:
        """Whether this is SQLite; the alternative is PostgreSQL."""
        return self.url.get_backend_name() == "sqlite"

    @property
    def file(self) -> Path:
        """The file of an SQLite store."""
        return Path(self.url.database or "")

    def _check_file(self) -> None:
        if self._watch is not None:
            self._watch.check()

    @contextmanager
    def read(self) -> Iterator[Connection]:
        """A transaction that sees one state of the database and writes nothing."""
        self._check_file()
        with self.reader.connect() as connection:
            yield connection

    @contextmanager
    def write(self, *, durable: bool = True) -> Iterator[Connection]:
        """A transaction that commits when the block ends and leaves nothing behind when it raises.

        What is not ``durable`` survives the end of this process, but maybe not that of the machine: its commit does not
        wait for the disk.
        """
        self._check_file()
        with self.writer.connect() as connection, self._soon(connection, durable), connection.begin():
            if not self.is_sqlite:  # its locks must not outlast a process that stands still
                connection.exec_driver_sql(f"SET LOCAL idle_in_transaction_session_timeout = {IDLE_MS}")
                if not durable:
                    connection.exec_driver_sql("SET LOCAL synchronous_commit = off")
            yield connection
            self._check_file()  # what is committed to a file that is gone must not be acknowledged

    @contextmanager
    def _soon(self, connection: Connection, durable: bool) -> Iterator[None]:
        """While SQLite does not wait for the disk, unless ``durable``; not to be changed within a transaction."""
        if durable or not self.is_sqlite:
            yield
            return
        execute = connection.connection.driver_connection.execute  # type: ignore[union-attr]
        execute("PRAGMA synchronous=NORMAL")
        try:
            yield
        finally:
            execute("PRAGMA synchronous=FULL")

    def ping(self) -> None:
        """Raise when the database does not answer."""
        with self.read() as connection:
            connection.execute(text("SELECT 1"))

    def obstacle(self) -> str:
        """What keeps the database from changes, if anything: the disk of an SQLite file is full, which PostgreSQL does
        not say of its own; or it is a standby."""
        if self.is_sqlite:
            return "" if disk_usage(self.file.absolute().parent).free > ROOM else "the disk of the database is full"
        with self.read() as connection:
            is_standby = connection.execute(text(STANDBY)).scalar_one()
        return "the database is a standby, which takes no changes" if is_standby else ""

    def close(self) -> None:
        """Close all connections and give up the claim."""
        self._opened.close()


def normalised(address: str) -> URL:
    """The URL of a database. Raises DatabaseError for what is not supported."""
    try:
        url = make_url(address)
    except (ArgumentError, ValueError):
        raise DatabaseError(f"'{address}' is no database URL; expected sqlite:///FILE or postgresql://...") from None
    if url.drivername in ("postgresql", "postgres"):
        return url.set(drivername="postgresql+psycopg")
    if url.drivername == "sqlite" and not url.database:
        raise DatabaseError("the SQLite URL needs a file: sqlite:///FILE")
    if url.drivername not in ("sqlite", "postgresql+psycopg"):
        raise DatabaseError(f"databases of kind '{url.drivername}' are not supported; use sqlite or postgresql")
    return url


def _engine(url: URL, key: bytes, *, writer: bool) -> Engine:
    """``key``: of seals (:mod:`service.database.seals`)."""
    if url.get_backend_name() != "sqlite":
        try:
            return _postgres(url, key)
        except ImportError:
            how = "pip install 'substructures[postgres]' (in a clone: pip install -e '.[postgres]')"
            raise DatabaseError(f"PostgreSQL needs the extra: {how}") from None
    engine = create_engine(
        url,
        pool_size=1 if writer else READERS,
        max_overflow=0,
        pool_timeout=60,
        connect_args={"timeout": BUSY_MS / 1000, "check_same_thread": False},
    )
    event.listen(engine, "connect", _configure)
    event.listen(engine, "connect", lambda _, record: record.info.update({KEY: key}))
    if not writer:
        event.listen(engine, "connect", lambda connection, _: connection.execute("PRAGMA query_only=ON"))
    # A deferred transaction that reads and then writes fails with "database is locked" under load. Of the driver, since
    # an event of the engine would be looked for with every statement.
    begin = "BEGIN IMMEDIATE" if writer else "BEGIN"
    engine.dialect.do_begin = lambda connection: connection.execute(begin)  # type: ignore[assignment, method-assign]
    return engine


def _postgres(url: URL, key: bytes) -> Engine:
    """What the URL says itself goes before."""
    limits = {"connect_timeout": CONNECT_SECONDS, **TCP}
    given = {name: value for name, value in limits.items() if name not in url.query}
    engine = create_engine(url, pool_size=READERS, pool_pre_ping=True, connect_args=given)
    event.listen(engine, "connect", _require_unicode, insert=True)  # before SQLAlchemy reads texts
    event.listen(engine, "connect", _watch_client)
    event.listen(engine, "connect", _set_clock)
    event.listen(engine, "connect", lambda _, record: record.info.update({KEY: key}))
    return engine


def _require_unicode(connection: Any, _record: object) -> None:
    """Texts have any characters. Raises DatabaseError."""
    found = connection.info.parameter_status("server_encoding")
    if found != "UTF8":
        how = "make it anew with CREATE DATABASE ... ENCODING 'UTF8' TEMPLATE template0"
        raise DatabaseError(f"the database has the encoding {found}, which not all characters can be kept in: {how}")


def _watch_client(connection: Any, _record: object) -> None:
    """Let the server notice when we are gone: with us go the locks that others wait for."""
    names = (name if name.startswith("tcp_") else f"tcp_{name}" for name in TCP)
    connection.execute("; ".join(f"SET {name} = {value}" for name, value in zip(names, TCP.values(), strict=True)))
    connection.commit()


def told(error: DBAPIError) -> str:
    """What the database said, in a line."""
    return (str(error.orig).strip() or type(error.orig).__name__).splitlines()[0]


def _snapshots(engine: Engine) -> Engine:
    """Read transactions whose statements all see the same state, as on SQLite."""
    return engine.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)


def set_clock(connection: Connection) -> None:
    """Set the clock of the store by that of PostgreSQL, in case somebody has set this host's; SQLite has none."""
    if connection.dialect.name != "sqlite":
        _set_clock_by(connection.exec_driver_sql)


def _set_clock(connection: Any, _record: object) -> None:
    _set_clock_by(connection.execute)
    connection.commit()


def _set_clock_by(ask: Callable[[str], Any]) -> None:
    asked = datetime.now(UTC)
    ((told,),) = ask("SELECT clock_timestamp()").fetchall()
    set_by(asked, told, datetime.now(UTC))


def _configure(connection: Any, _record: object) -> None:
    connection.isolation_level = None  # the driver must not begin transactions of its own
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")  # acknowledged means on the disk
    connection.execute(f"PRAGMA busy_timeout={BUSY_MS}")
    connection.execute("PRAGMA foreign_keys=ON")
