"""Tables of sweeps as JSON and as files."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from service.messages.answers import Sink
from service.messages.negotiation import most_wanted
from service.messages.refusals import Refused
from service.operations.jobs.tables import Table
from substructures.formats import arrow
from substructures.formats.npz_writer import NpzWriter

CSV, NPZ, PARQUET = "text/csv", "application/x-npz", "application/vnd.apache.parquet"
FILES = (CSV, NPZ, arrow.MEDIA_TYPE, PARQUET)
JSON = "application/json"
AT_A_TIME, OF_A_GROUP = 10_000, 250_000  # rows that become text, and numbers of a file, in one piece


def chosen_media(accept: str) -> str:
    """The media type of the answer. Raises Refused 406."""
    found = most_wanted(accept, (JSON, *FILES))
    if found is None:
        raise Refused(406, "not-acceptable", f"answers are {', '.join((JSON, *FILES))}")
    if found in (arrow.MEDIA_TYPE, PARQUET) and not arrow.is_available():
        detail = "this server has no Arrow: install it with the extra 'substructures[arrow]', or use text/csv"
        raise Refused(406, "arrow-not-installed", detail)
    return found


def as_file(table: Table, media: str) -> Iterator[bytes | memoryview]:
    """All rows of a table as one of FILES, which are sent while they grow."""
    return as_csv(table) if media == CSV else as_npz(table) if media == NPZ else as_arrow(table, media)


def rows_view(table: Table, start: int, stop: int) -> dict[str, Any]:
    """Some rows of a table."""
    columns = {name: each.tolist() for name, each in table.rows(start, stop).columns.items()}
    items = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    return {"columns": list(columns), "items": items, "count": table.count, **table.about}


def as_csv(table: Table) -> Iterator[bytes]:
    """All rows of a table, some at a time: as text they are many times as long as they are."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow(table.columns)
    for start in range(0, max(1, table.count), AT_A_TIME):
        columns = table.rows(start, start + AT_A_TIME).columns
        writer.writerows(zip(*(each.tolist() for each in columns.values()), strict=True))
        yield text.getvalue().encode()
        text.seek(0)
        text.truncate()


def as_npz(table: Table) -> Iterator[memoryview]:
    """All rows of a table, column by column."""
    writer = NpzWriter()
    for name, values in table.columns.items():
        yield from writer.whole(name, values)
    yield writer.directory()


def as_arrow(table: Table, media: str) -> Iterator[bytes]:
    """All rows of a table as an Arrow stream or as Parquet, some at a time: record batches, or row groups."""
    pyarrow = import_module("pyarrow")
    sink, schema = Sink(), pyarrow.table(dict(table.rows(0, 0).columns)).schema
    texts = [field.name for field in schema if pyarrow.types.is_string(field.type)]
    with (
        import_module("pyarrow.parquet").ParquetWriter(sink, schema, compression="zstd", use_dictionary=texts)
        if media == PARQUET
        else pyarrow.ipc.new_stream(sink, schema)
    ) as writer:
        for start in range(0, table.count, OF_A_GROUP):
            writer.write_table(pyarrow.table(dict(table.rows(start, start + OF_A_GROUP).columns), schema))
            yield sink.taken()
    yield sink.taken()
