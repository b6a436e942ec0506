"""Arrow streams in and out: one row for each state, one column for each array.

Needs pyarrow (``pip install 'substructures[arrow]'``): an extra because of its size, and pyarrow because the bytes
come from strangers: its reader checks what it reads, which the small readers of the format do not.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from math import prod
from typing import IO, Any

import numpy as np
import orjson
from numpy.typing import NDArray

from substructures.array import Array
from substructures.documents import pointer_step
from substructures.errors import InvalidDocument, TooLarge
from substructures.formats.arrays import flat


class _Late:
    """pyarrow, loaded when something of it is used."""

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module("pyarrow"), name)


pa: Any = _Late() if find_spec("pyarrow") else None

MEDIA_TYPE = "application/vnd.apache.arrow.stream"
END = b"\xff\xff\xff\xff\x00\x00\x00\x00"  # the end-of-stream marker
#: columns of texts: what is to be said of a state, as JSON
FAILURES, WARNINGS = "failures", "warnings"
# places in the flatbuffers of the format's Message.fbs: Message.header, RecordBatch.compression
_HEADER, _COMPRESSION = 2, 3


def is_available() -> bool:
    """Whether pyarrow is installed."""
    return pa is not None


class _Guarded(io.RawIOBase):
    """A file that refuses to read more than ``limit`` bytes at a time: no message can be larger."""

    def __init__(self, file: IO[bytes], limit: int) -> None:
        self.file, self.limit = file, limit

    def readable(self) -> bool:
        """Yes."""
        return True

    def read(self, size: int = -1) -> bytes:
        """Read, unless a batch declares more than the limit. Raises TooLarge."""
        if not 0 <= size <= self.limit:
            raise TooLarge("a record batch (in bytes)", size, self.limit)
        return self.file.read(size)


class Reader:
    """The record batches of a stream as arrays by column name; ``metadata``: that of the schema."""

    def __init__(self, file: IO[bytes], limit: int) -> None:
        """Read the schema; ``limit``: bytes of one record batch. Raises InvalidDocument, TooLarge."""
        with _Translated():
            self._messages = pa.ipc.MessageReader.open_stream(_Guarded(file, limit))
            message = self._messages.read_next_message()
            _check_kind(message, "schema")
            self._schema = pa.ipc.read_schema(message)
            self.metadata = {key.decode(): value for key, value in (self._schema.metadata or {}).items()}

    def __iter__(self) -> Iterator[dict[str, Array]]:
        """Arrays (N,) or (N, n) of doubles."""
        while (message := self._next()) is not None:
            with _Translated():
                _check_kind(message, "record batch")
                _check_plain(message)
                batch = pa.ipc.read_record_batch(message, self._schema)
                batch.validate(full=True)
                columns = _columns(batch)
            yield columns

    def _next(self) -> Any:
        with _Translated():
            try:
                return self._messages.read_next_message()
            except StopIteration:
                return None


class _Translated:
    """Makes the faults that pyarrow finds those of a document."""

    def __enter__(self) -> None:
        pass

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        if isinstance(error, (pa.ArrowException, OSError, StopIteration, LookupError, UnicodeError)):
            reason = str(error).partition("\n")[0] or "it has no schema"
            raise InvalidDocument.at("", "arrow", f"not an Arrow stream: {reason}") from None


def _check_kind(message: Any, kind: str) -> None:
    if message.type != kind:  # pyarrow takes it for granted
        raise InvalidDocument.at("", "arrow", f"a message of kind '{message.type}' where a {kind} is expected")


def _check_plain(message: Any) -> None:
    data = message.metadata.to_pybytes()
    header = _field(data, struct.unpack_from("<I", data)[0], _HEADER)
    batch = header + struct.unpack_from("<I", data, header)[0]
    if _field(data, batch, _COMPRESSION):  # what it unpacks to has no limit
        raise InvalidDocument.at("", "arrow", "compressed record batches are not accepted")


def _field(data: bytes, table: int, number: int) -> int:
    """The position of a field of a flatbuffers table, 0 when it is absent; pyarrow has verified the buffer."""
    names = table - struct.unpack_from("<i", data, table)[0]
    entry = 4 + 2 * number
    offset = struct.unpack_from("<H", data, names + entry)[0] if entry < struct.unpack_from("<H", data, names)[0] else 0
    return table + offset if offset else 0


def _columns(batch: Any) -> dict[str, Array]:
    names = batch.schema.names
    if len(set(names)) < len(names):
        raise InvalidDocument.at("", "arrow", "two columns have the same name")
    return {name: _column(name, batch.column(i)) for i, name in enumerate(names)}


def _column(name: str, column: Any) -> Array:
    pointer, kind = pointer_step(name), column.type
    is_list = pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind)
    number = kind.value_type if is_list else kind
    if not (pa.types.is_floating(number) or pa.types.is_integer(number)):
        raise InvalidDocument.at(pointer, "column-type", f"a column of type {kind} is not accepted; send doubles")
    values = column.flatten() if is_list else column
    if column.null_count or values.null_count:
        raise InvalidDocument.at(pointer, "null", f"column '{name}' has nulls; a number is needed for every state")
    array = np.asarray(values.to_numpy(zero_copy_only=False), dtype=np.float64)
    return array.reshape(len(column), _width(pointer, column)) if is_list else array


def _width(pointer: str, column: Any) -> int:
    if pa.types.is_fixed_size_list(column.type):
        return int(column.type.list_size)
    lengths = np.unique(column.value_lengths().to_numpy(zero_copy_only=False))
    if len(lengths) > 1:
        raise InvalidDocument.at(pointer, "wrong-length", "the lists of a column have different lengths")
    return int(lengths.sum())


@dataclass(frozen=True, slots=True)
class ArrowTable:
    """Columns (N, ...); ``missing``: True where a column has no value; ``notes``: columns of texts by state, if any."""

    columns: Mapping[str, Array]
    missing: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)
    notes: Mapping[str, Mapping[int, str]] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """The number of rows."""
        return max(map(len, self.columns.values()), default=0)


def table_of(answer: Mapping[str, Any], names: Iterable[str]) -> ArrowTable:
    """The named parts of the answer of an evaluation with a leading axis, with notes for every state that failed and
    every one that is doubtful.
    """
    columns, count = flat({name: answer[name] for name in names}), answer["count"]
    missing: dict[str, NDArray[np.bool_]] = {}
    for failure in answer[FAILURES]:
        state, quantity = failure["state"], failure["quantity"]
        for name in columns:
            if name == quantity or name.startswith(f"{quantity}."):
                missing.setdefault(name, np.zeros(count, np.bool_))[state] = True
    return ArrowTable(columns, missing, {kind: _notes(answer[kind]) for kind in (FAILURES, WARNINGS)})


def _notes(rows: Iterable[Mapping[str, Any]]) -> dict[int, str]:
    """Rows about states as one text for each state; a row that is about none, or several, stands at the first."""
    found: dict[int, list[dict[str, Any]]] = {}
    for row in rows:
        # where a state is told by the row, a pointer to it would tell another one as soon as the row is moved
        local = ("state", "pointer") if "state" in row else ()
        about = {key: value for key, value in row.items() if key not in local}
        found.setdefault(row.get("state", 0), []).append(about)
    return {state: orjson.dumps(some).decode() for state, some in found.items()}


def write_tables(tables: Iterable[ArrowTable], metadata: Mapping[str, Any]) -> Iterator[memoryview | bytes]:
    """The pieces of a stream, one record batch for each table; all tables have the columns of the first.

    A column (N, ...) of more than one axis becomes fixed-size lists, row-major, with the ``shape`` of one state in the
    metadata of the field; values of ``metadata`` that are no texts become JSON, as Arrow metadata are texts.
    """
    schema = None
    for table in tables:
        arrays = [_to_arrow(values, table.missing.get(name)) for name, values in table.columns.items()]
        arrays += [_texts(notes, table.count) for notes in table.notes.values()]
        if schema is None:
            fields = [_field_of(name, values) for name, values in table.columns.items()]
            fields += [pa.field(kind, pa.string()) for kind in table.notes]
            texts = {key: v if isinstance(v, str) else orjson.dumps(v) for key, v in metadata.items()}
            schema = pa.schema(fields, metadata=texts)
            yield memoryview(schema.serialize())
        yield memoryview(pa.record_batch(arrays, schema=schema).serialize())
    yield END


def read_tables(file: io.BufferedIOBase) -> Iterator[dict[str, Any]]:
    """The batches of a stream from :func:`write_tables`: arrays (N, ...), ``failures`` and ``warnings``, with places in
    the batch where they are about one state.
    """
    for batch in pa.ipc.open_stream(file):
        result: dict[str, Any] = {"count": len(batch)}
        for described in batch.schema:
            values = batch.column(described.name)
            if described.name in (FAILURES, WARNINGS):
                notes = {i: orjson.loads(text) for i, text in enumerate(values.to_pylist()) if text is not None}
                # what has a pointer is about no single state
                result[described.name] = [
                    each if "pointer" in each else {"state": i, **each} for i, note in notes.items() for each in note
                ]
            else:
                result[described.name] = _from_arrow(values, orjson.loads(described.metadata[b"shape"]))
        yield result


def _from_arrow(column: Any, shape: list[int]) -> Array:
    if not shape:
        return column.to_numpy(zero_copy_only=False)
    values: Array = column.values.to_numpy(zero_copy_only=False).reshape(len(column), *shape)
    if not column.null_count:
        return values
    gone = column.is_null().to_numpy(zero_copy_only=False).reshape(len(column), *(1 for _ in shape))
    return np.where(gone, np.nan, values)


def _texts(notes: Mapping[int, str], count: int) -> Any:
    return pa.array([notes.get(i) for i in range(count)], pa.string()) if notes else pa.nulls(count, pa.string())


def _field_of(name: str, values: Array) -> Any:
    shape = values.shape[1:]
    number = _number_type(values)
    kind = pa.list_(number, prod(shape)) if shape else number
    return pa.field(name, kind, metadata={"shape": orjson.dumps(shape)})


def _number_type(values: Array) -> Any:
    return pa.float32() if values.dtype == np.float32 else pa.float64()


def _to_arrow(values: Array, missing: NDArray[np.bool_] | None) -> Any:
    mask = None if missing is None else pa.array(missing)
    if values.ndim == 1:
        return pa.array(values, mask=missing)
    flat, width = pa.array(np.ascontiguousarray(values).reshape(-1)), prod(values.shape[1:])
    if not width:  # from_arrays cannot tell how many rows there are
        return pa.Array.from_buffers(pa.list_(_number_type(values), 0), len(values), [None], children=[flat])
    return pa.FixedSizeListArray.from_arrays(flat, width, mask=mask)
