"""Tables of sweeps as JSON and as files."""

from __future__ import annotations

import csv
import io
from importlib import import_module
from typing import Any

from service.messages.negotiation import by_preference
from service.messages.refusals import Refused
from service.operations.jobs.tables import Table
from substructures.formats import arrow
from substructures.formats.arrays import write_npz

CSV, NPZ, PARQUET = "text/csv", "application/x-npz", "application/vnd.apache.parquet"
FILES = (CSV, NPZ, arrow.MEDIA_TYPE, PARQUET)
JSON = "application/json"


def chosen_media(accept: str) -> str:
    """The media type of the answer. Raises Refused 406."""
    for pattern in by_preference(accept or "*/*"):
        if pattern in ("*/*", "application/*", JSON):
            return JSON
        if pattern in FILES:
            if pattern in (arrow.MEDIA_TYPE, PARQUET) and not arrow.is_available():
                detail = "this server has no Arrow: install it with the extra 'substructures[arrow]', or use text/csv"
                raise Refused(406, "arrow-not-installed", detail)
            return pattern
    raise Refused(406, "not-acceptable", f"answers are {', '.join((JSON, *FILES))}")


def rows_view(table: Table, start: int, stop: int) -> dict[str, Any]:
    """Some rows of a table."""
    columns = {name: each.tolist() for name, each in table.rows(start, stop).columns.items()}
    items = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    return {"columns": list(columns), "items": items, "count": table.count, **table.about}


def as_file(table: Table, media: str) -> bytes:
    """All rows of a table."""
    if media == NPZ:
        return b"".join(write_npz(table.columns).pieces)
    if media == CSV:
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        writer.writerow(table.columns)
        writer.writerows(zip(*(each.tolist() for each in table.columns.values()), strict=True))
        return text.getvalue().encode()
    pyarrow = import_module("pyarrow")
    made, sink = pyarrow.table(dict(table.columns)), io.BytesIO()
    if media == PARQUET:
        import_module("pyarrow.parquet").write_table(made, sink, compression="zstd")
    else:
        with pyarrow.ipc.new_stream(sink, made.schema) as stream:
            stream.write_table(made)
    return sink.getvalue()
