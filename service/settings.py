"""Settings of the server, all from the environment (``SUBSTRUCTURES_...``) or the command line, and all its limits."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from service.processes.accepting import PROCESSES
from service.sources import read_source
from substructures.compile.setting import VARIABLES, Setting
from substructures.documents import message_of
from substructures.errors import meant

PREFIX = "SUBSTRUCTURES_"
LIMIT_PREFIX = "LIMIT_"
CLIENT = ("key", "server")  # variables of the commands that talk to a server; no settings of a server
#: variables of the compiler of kernels, see :mod:`substructures.compile.setting`
COMPILER = tuple(name[len(PREFIX) :].lower() for name in VARIABLES)
#: limits that several processes share out
SHARED = ("connections", "connections_per_address", "event_streams", "event_streams_per_key")
LISTS = ("allowed_hosts", "mirror_sources")  # separated by commas
LOOPBACK = ("localhost", "127.0.0.1", "::1")

# Bounds of limits are what a database, a kernel and a clock can still be told: 2^62, a year, a century.
Count = Annotated[int, Field(gt=0, le=2**62)]
Seconds = Annotated[float, Field(gt=0, le=366 * 86400)]
Hours = Annotated[float, Field(gt=0, le=36525 * 24)]
Days = Annotated[float, Field(gt=0, le=36525)]


class SettingsError(Exception):
    """A setting that cannot be used; the message names it."""


class Limits(BaseModel):
    """The limits of the service. Set one with ``SUBSTRUCTURES_LIMIT_<NAME>``; ``GET /v1/limits`` shows all.

    What belongs to the format of documents itself (digits of numbers, exponents, nesting) is fixed by the science
    package, so that a definition accepted by one server is accepted by all.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    json_bytes: Count = Field(2 * 2**20, description="largest JSON request body, bytes")
    binary_bytes: int = Field(64 * 2**20, gt=0, le=2**30, description="largest npz body or Arrow record batch, bytes")
    stream_bytes: Count = Field(2**32, description="largest Arrow request body, bytes; kept in a temporary file")
    stream_states: Count = Field(10**8, description="most states of one Arrow request")
    program_nodes: Count = Field(100_000, description="most operations of a derived or coupled program")
    sync_nodes: Count = Field(25_000, description="operations beyond which deriving becomes a job at once")
    sync_seconds: Seconds = Field(10.0, description="CPU time that a request may take, seconds")
    states: Count = Field(1_000_000, description="most states of one evaluation")
    evaluation_operations: Count = Field(2 * 10**9, description="most states times operations of one evaluation")
    connections: Count = Field(512, description="most open connections; never more than half of the descriptors")
    connections_per_address: Count = Field(256, description="most open connections of one address (IPv6: /64)")
    head_bytes: int = Field(65536, ge=1024, le=2**24, description="longest head of a request, bytes")
    url_bytes: int = Field(65535, ge=256, le=65535, description="longest URL, bytes")
    head_seconds: Seconds = Field(10.0, description="longest time until the head of a request is there, seconds")
    body_seconds: Seconds = Field(60.0, description="longest time that a body may be behind 500 bytes/s, seconds")
    answer_seconds: Seconds = Field(300.0, description="longest time for which nothing of an answer is read, seconds")
    event_streams: Count = Field(100, description="most streams of events of jobs")
    event_streams_per_key: Count = Field(50, description="most streams of events of one API key")
    upload_bytes: Count = Field(2**35, description="uploaded states that are kept, bytes")
    upload_bytes_per_key: Count = Field(2**33, description="uploaded states that are kept of one API key, bytes")
    result_bytes: Count = Field(2**36, description="results of jobs that are kept, bytes")
    result_bytes_per_key: Count = Field(2**35, description="results of jobs that are kept of one API key, bytes")
    answer_bytes: Count = Field(2**31, description="answers kept under idempotency keys, bytes")
    answer_bytes_per_key: Count = Field(2**29, description="answers kept under idempotency keys of one API key, bytes")
    kernel_bytes: Count = Field(2**32, description="folder of compiled kernels, bytes; those used least lately go")
    page_size: Count = Field(1000, description="most items of a page")
    idempotency_hours: Hours = Field(24.0, description="how long an Idempotency-Key is remembered, hours")
    job_bytes: Count = Field(16 * 2**20, description="largest JSON body that submits a job, bytes")
    job_queue: Count = Field(200_000, description="most unfinished items of all jobs")
    job_queue_per_key: Count = Field(100_000, description="most unfinished items of the jobs of one API key")
    job_seconds: Seconds = Field(1800.0, description="longest time of one attempt on an item, seconds")
    lease_seconds: Seconds = Field(20.0, description="after this time the items of a dead server are taken over")
    job_days: Days = Field(30.0, description="how long finished jobs and their results are kept, days")
    upload_hours: Hours = Field(1.0, description="how long uploaded states without a job are kept, hours")
    job_items: Count = Field(20_000, description="most items of one job")
    job_states: Count = Field(10_000, description="most states of one item; larger sets are split into items")
    job_nodes: Count = Field(1_000_000, description="most operations of a program derived or coupled by a job")
    job_cpu_seconds: Seconds = Field(600.0, description="CPU time of one item of a job, seconds")
    job_memory_bytes: Count = Field(2 * 2**30, description="memory of the process that computes an item, bytes")


class Settings(BaseModel):
    """How one server runs."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    database: str = Field("sqlite:///substructures.db", description="SQLAlchemy URL; SQLite or PostgreSQL")
    host: str = Field("127.0.0.1", description="address to listen on")
    port: int = Field(8000, ge=0, le=65535, description="port to listen on; 0 takes a free one")
    allowed_hosts: tuple[str, ...] = Field(LOOPBACK, description="values accepted in the Host header; * accepts all")
    catalogue: bool = Field(True, description="import the shipped catalogue when the server starts")
    folder: str = Field("", description="folder of definitions, JSON and YAML, that the server reads; empty: none")
    cache_nodes: int = Field(
        2_000_000,
        ge=0,
        le=2**62,
        description="operations of decoded programs kept in memory, and 56 bytes of files and answers for each",
    )
    engine: Literal["local", "dask", "none"] = Field("local", description="what computes jobs; none: another process")
    engine_address: str = Field("", description="address of the Dask scheduler, tcp://...")
    processes: int = Field(1, ge=1, le=PROCESSES, description="processes that answer requests")
    workers: int = Field(0, ge=0, le=10_000, description="processes that compute jobs; 0: one per core")
    runner_user: str = Field("", description="user of the processes that compute jobs; empty: that of the server")
    kernels: str = Field("", description="folder of compiled kernels; empty: beside the SQLite file, '-': none")
    seal_key: str = Field(
        "",
        description="file of 32 random bytes, the key of seals of a store; empty: that beside the SQLite file",
    )
    mirror_sources: tuple[str, ...] = Field(
        (), repr=False, description="instances that may be mirrored, with commas: https://host or https://key@host"
    )
    key_seconds: float = Field(1.0, ge=0, le=86400, description="for how long a key is not checked again, seconds")
    limits: Limits = Limits()

    @field_validator("database")
    @classmethod
    def _address(cls, text: str) -> str:
        """The name of a file is that of an SQLite file."""
        return f"sqlite:///{text}" if text and ":" not in text else text

    @field_validator("mirror_sources")
    @classmethod
    def _readable(cls, texts: tuple[str, ...]) -> tuple[str, ...]:
        for number, text in enumerate(texts, 1):
            try:
                read_source(text)
            except ValueError as error:  # not pydantic's, which tells what was given: a key, perhaps
                raise SettingsError(f"{PREFIX}MIRROR_SOURCES, number {number}: {error}") from None
        return texts

    @property
    def kernel_folder(self) -> Path | None:
        """Where compiled kernels are kept between starts, if anywhere."""
        if self.kernels:
            return None if self.kernels == "-" else Path(self.kernels)
        file = self.database.removeprefix("sqlite:///")
        return Path(f"{file}.kernels") if file not in (self.database, "", ":memory:") else None

    @property
    def limits_of_process(self) -> Limits:
        """The limits with this process's share of what is open at a time, at least one of each."""
        limits = self.limits
        shares = {name: -(-getattr(limits, name) // self.processes) for name in SHARED}
        return limits.model_copy(update=shares)

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine can reach the address listened on."""
        return self.host in LOOPBACK


def from_environment(environment: Mapping[str, str], **overrides: object) -> Settings:
    """Settings from ``SUBSTRUCTURES_*`` variables; ``overrides`` that are not None win, from options of that name.

    Variables of the client are left alone, those of the compiler are checked only. Raises SettingsError naming the
    variable or option, also for one that no setting has (a typing error would go unnoticed).
    """
    given = {name[len(PREFIX) :].lower(): text for name, text in environment.items() if name.startswith(PREFIX)}
    given = {name: text for name, text in given.items() if name not in (*CLIENT, *COMPILER)}
    prefix = LIMIT_PREFIX.lower()
    values: dict[str, object] = {name: text for name, text in given.items() if not name.startswith(prefix)}
    for name in LISTS:
        if name in given:
            values[name] = tuple(text.strip() for text in given[name].split(",") if text.strip())
    values["limits"] = {name[len(prefix) :]: text for name, text in given.items() if name.startswith(prefix)}
    values.update({name: value for name, value in overrides.items() if value is not None})
    try:
        Setting.read(environment)
        return Settings.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        name = str(first["loc"][0])
        of_command_line = overrides.get(name) is not None
        place = f"--{name.replace('_', '-')}" if of_command_line else _variable(first["loc"])
        like = _meant(place) if first["type"] == "extra_forbidden" else ""
        raise SettingsError(f"{place}: {message_of(first)}{like}") from None
    except ValueError as error:
        raise SettingsError(str(error)) from None


def _meant(variable: str) -> str:
    """The setting that may have been meant, a limit without LIMIT first."""
    limits = [_variable(("limits", name)) for name in Limits.model_fields]
    known = [*(_variable((name,)) for name in Settings.model_fields if name != "limits"), *limits]
    ends = [name for name in limits if name == f"{PREFIX}{LIMIT_PREFIX}{variable.removeprefix(PREFIX)}"]
    return f"; did you mean '{ends[0]}'?" if ends else meant(variable, known)


def _variable(location: tuple[int | str, ...]) -> str:
    parts = [str(part) for part in location]
    if parts[0] == "limits":
        parts[0] = LIMIT_PREFIX.rstrip("_")
    return PREFIX + "_".join(parts[:2] if parts[0] == LIMIT_PREFIX.rstrip("_") else parts[:1]).upper()
