"""Summaries of stored trees in one part, as older versions stored them."""

from __future__ import annotations

import sqlite3

from service.content.integrity import digest_of
from service.content.tree_summaries import summary_text


def whole_summary(connection: sqlite3.Connection) -> str:
    """Of the tree that is stored first."""
    query = (
        "SELECT spec, summary_values, content FROM trees LEFT JOIN summary_forms ON summary_forms.digest = summary_form"
    )
    spec, values, form = connection.execute(query).fetchone()
    return summary_text(values, form, spec)


def put_whole_summary(connection: sqlite3.Connection, text: str) -> None:
    """Of all trees."""
    values = text, digest_of(text.encode())
    connection.execute("UPDATE trees SET summary_values = ?, summary_digest = ?, summary_form = NULL", values)
