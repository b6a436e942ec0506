"""Sweeps of one server: submit them, and read their tables as arrays and frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.client.answers import Answer
from substructures.client.frames import Tabular
from substructures.client.jobs import Job, JobCaller
from substructures.client.steps import Referable, step
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrays import read_npz

#: media types of tables by the endings of files
MEDIA = {
    ".csv": "text/csv",
    ".npz": NPZ,
    ".arrow": "application/vnd.apache.arrow.stream",
    ".parquet": "application/vnd.apache.parquet",
    ".json": "application/json",
}


class SweepTable(Tabular):
    """Rows of a sweep: columns by name, as members and items; ``to_pandas()`` and ``to_polars()`` are frames."""

    def __init__(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        super().__init__(dict(arrays))

    def __repr__(self) -> str:
        return f"SweepTable of {len(self['row']):,} rows: {', '.join(self)}"

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns by name, one row for each row of the sweep."""
        return {name: np.asarray(x) for name, x in self.items()}


class SweepCaller(JobCaller):
    """What can be done with sweeps."""

    def sweep(self, document: Mapping[str, Any], progress: bool = False) -> Job:
        """Submit a sweep and wait until it has ended, with a bar on the stream of errors if ``progress``: the job."""
        return self.submit_job({"kind": "sweep", **document}).wait(progress)

    def table(
        self, job: str | Referable, *, where: str = "", sort: str = "", columns: Sequence[str] = (), front: bool = False
    ) -> SweepTable:
        """The rows of a sweep that fit, also while it runs; ``front``: those on its Pareto front alone.

        ``where``: a condition over columns, ``mass < 3 and torque < 180``; ``sort``: columns, ``-torque,mass``.
        """
        query = {"where": where, "sort": sort, "columns": ",".join(columns)}
        content = self.table_file(job, NPZ, query, front)
        return SweepTable(read_npz(BytesIO(content), len(content)))

    def table_file(self, job: str | Referable, media: str, query: Mapping[str, str], front: bool = False) -> bytes:
        """The same as a file of a media type."""
        path = f"/v1/jobs/{step(job)}/{'pareto' if front else 'table'}"
        params = {name: x for name, x in query.items() if x}
        return self.request("GET", path, params=params, headers={"Accept": media}).content

    def column(self, job: str | Referable, name: str, *, where: str = "", bins: int = 20) -> Answer:
        """How the values of a column are distributed: count, mean, deviation, quantiles, histogram."""
        params = {"bins": bins, **({"where": where} if where else {})}
        return self.told("GET", f"/v1/jobs/{step(job)}/table/columns/{step(name)}", params=params)

    def store_row(self, job: str | Referable, row: int, name: str | None = None) -> dict[str, Any]:
        """Store the tree of a row: the tree."""
        body = {} if name is None else {"name": name}
        return dict(self.told("POST", f"/v1/jobs/{step(job)}/rows/{row}/tree", body))
