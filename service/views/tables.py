"""Tables of sweeps as JSON and as files."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from service.messages.negotiation import most_wanted
from service.messages.refusals import Refused
from service.operations.jobs.tables import Table
from substructures.formats import arrow
from substructures.formats.arrays import write_npz

CSV, NPZ, PARQUET = "text/csv", "application/x-npz", "application/vnd.apache.parquet"
FILES = (CSV, NPZ, arrow.MEDIA_TYPE, PARQUET)
JSON = "application/json"
AT_A_TIME = 10_000  # rows


def chosen_media(accept: str) -> str:
    """The media type of the answer. Raises Refused 406."""
    found = most_wanted(accept, (JSON, *FILES))
    if found is None:
        raise Refused(406, "not-acceptable", f"answers are {', '.join((JSON, *FILES))}")
    if found in (arrow.MEDIA_TYPE, PARQUET) and not arrow.is_available():
        detail = "this server has no Arrow: install it with the extra 'substructures[arrow]', or use text/csv"
        raise Refused(406, "arrow-not-installed", detail)
    return found


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


def as_file(table: Table, media: str) -> bytes:
    """All rows of a table, but as CSV."""
    if media == NPZ:
        return b"".join(write_npz(table.columns).pieces)
    pyarrow = import_module("pyarrow")
    made, sink = pyarrow.table(dict(table.columns)), io.BytesIO()
    if media == PARQUET:
        import_module("pyarrow.parquet").write_table(made, sink, compression="zstd")
    else:
        with pyarrow.ipc.new_stream(sink, made.schema) as stream:
            stream.write_table(made)
    return sink.getvalue()
