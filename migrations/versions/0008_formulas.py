"""The index of formulas in two columns of parts, a tenth of the bytes; the view ``formulas`` has its rows as before."""

from __future__ import annotations

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"

VIEWS = {
    "sqlite": """
        CREATE VIEW formulas AS
        SELECT p.digest AS part, f.key AS position, json_extract(o.value, '$[0]') AS quantity,
               json_extract(f.value, '$[1]') AS body, json_extract(f.value, '$[2]') AS coordinate,
               json_extract(o.value, '$[2]') AS shape, json_extract(o.value, '$[3]') AS symmetry,
               json_extract(f.value, '$[4]') AS operations, json_extract(o.value, '$[1]') AS output,
               json_extract(f.value, '$[3]') AS entry
        FROM parts p, json_each(p.formulas) f, json_each(p.outputs) o WHERE o.key = json_extract(f.value, '$[0]')""",
    "postgresql": """
        CREATE VIEW formulas AS
        SELECT p.digest AS part, (f.number - 1)::integer AS position, o.value ->> 0 AS quantity,
               f.value ->> 1 AS body, f.value ->> 2 AS coordinate, o.value ->> 2 AS shape, o.value ->> 3 AS symmetry,
               (f.value ->> 4)::integer AS operations, o.value ->> 1 AS output, f.value ->> 3 AS entry
        FROM parts p, json_array_elements(p.formulas::json) WITH ORDINALITY AS f(value, number),
             json_array_elements(p.outputs::json) WITH ORDINALITY AS o(value, number)
        WHERE o.number - 1 = (f.value ->> 0)::integer""",
}
OLD = ("quantity", "output", "shape", "symmetry", "body", "coordinate", "entry", "operations")


def upgrade() -> None:
    """Add the columns, fill them part by part, and put the view in the place of the table."""
    for name in ("outputs", "formulas"):
        op.add_column("parts", sa.Column(name, sa.Text(), nullable=False, server_default="[]"))
    connection = op.get_bind()
    old = sa.table("formulas", *map(sa.column, ("part", "position", *OLD)))
    parts = sa.table("parts", *map(sa.column, ("digest", "outputs", "formulas")))
    rows = sa.select(*(old.c[name] for name in OLD)).order_by(old.c.position)
    for digest in connection.execute(sa.select(parts.c.digest)).scalars().all():
        found = connection.execute(rows.where(old.c.part == digest)).all()
        connection.execute(sa.update(parts).where(parts.c.digest == digest).values(_packed(found)))
    op.drop_table("formulas")
    op.execute(VIEWS[connection.dialect.name])


def _packed(rows: Any) -> dict[str, str]:
    """What the formulas of an output have in common, and what each of them has for itself."""
    outputs: dict[tuple[str, ...], int] = {}
    formulas = []
    for *common, body, coordinate, entry, operations in rows:
        number = outputs.setdefault(tuple(common), len(outputs))
        formulas.append([number, body, coordinate, json.loads(entry), operations])
    shown = [[quantity, output, json.loads(shape), symmetry] for quantity, output, shape, symmetry in outputs]
    return {
        name: json.dumps(value, separators=(",", ":")) for name, value in (("outputs", shown), ("formulas", formulas))
    }
