"""Conditions on the states of items, spelled as constants: a partial index serves no bound value."""

from __future__ import annotations

from sqlalchemy import literal_column

from service.database.job_tables import job_items

OPEN = ("queued", "running", "cancelling")
QUEUED = job_items.c.state == literal_column("'queued'")
RUNNING = job_items.c.state == literal_column("'running'")
