"""Bytes of the database for every stored part: of the shipped catalogue, then with generated parts besides.

python -m benchmarks.store [--quick] [--database URL] [--json FILE]

Of an SQLite file, or of the empty database at the URL. tables take that are empty is left out, and printed. The
generated parts are chains of one to eight joints, of numbers and symbols.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.report import keep, options
from service.content.summaries import part_content
from service.database.connections import Connection, Database
from service.operations.catalogue import store_part
from substructures import Definition, catalogue, derive

#: of SQLite its pages, of PostgreSQL its files
TABLES = {
    "sqlite": "SELECT name, sum(pgsize) FROM dbstat GROUP BY name",
    "postgresql": """SELECT relname, pg_table_size(oid) FROM pg_class
                     WHERE relkind IN ('r', 'i') AND relnamespace = 'public'::regnamespace""",
}


def generated(seed: int) -> Definition:
    """A chain of joints, every seventh prismatic; a symbol for every mass, all else are numbers."""
    chance = np.random.default_rng(seed)
    count = 1 + seed % 8
    bodies = [
        {
            "name": f"link{k}",
            "parent": f"link{k - 1}" if k else "base",
            "joint": {
                "type": "prismatic" if chance.random() < 1 / 7 else "revolute",
                "coordinate": f"q{k}",
                "theta": "pi/2" if chance.random() < 1 / 2 else 0,
                "d": round(chance.random(), 3),
            },
            "mass": f"m{k}",
            "com": [round(chance.random(), 3) for _ in range(3)],
            "inertia": {"xx": "1/10", "yy": "1/10", "zz": "1/10"},
        }
        for k in range(count)
    ]
    parameters: dict[str, Any] = {f"m{k}": {"value": k + 1, "unit": "kg"} for k in range(count)}
    port = {"name": "tip", "body": bodies[-1]["name"], "position": [0.1, 0, 0]}
    return Definition.read({"name": f"chain{seed}", "parameters": parameters, "bodies": bodies, "ports": [port]})


def sizes(connection: Connection) -> Counter[str]:
    """Bytes of every table and index."""
    rows = connection.exec_driver_sql(TABLES[connection.dialect.name])
    return Counter({name: int(size) for name, size in rows})


def main() -> None:
    """Print kilobytes of every part, and of what they consist."""
    parser = options(__doc__, "100 generated parts instead of 2,000")
    parser.add_argument("--database", metavar="URL", help="an empty database")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        database = Database(arguments.database or f"sqlite:///{Path(folder) / 'store.db'}")
        with database.read() as connection:
            before = sizes(connection)
        print(f"empty: {before.total() / 1000:.0f} kB")
        made = 0
        shipped = [Definition.read(catalogue.load(name)) for name in catalogue.names()]
        more = (generated(k) for k in range(100 if arguments.quick else 2000))
        for kind, definitions in (("shipped", shipped), ("generated", more)):
            for definition in definitions:
                content = part_content(derive(definition))
                with database.write() as connection:
                    store_part(connection, content)
                made += 1
            with database.read() as connection:
                grown = sizes(connection) - before
            most = ", ".join(f"{name} {size / made / 1000:.1f}" for name, size in grown.most_common(8))
            print(f"{kind:>10}: {grown.total() / made / 1000:6.1f} kB a part, {made} parts ({most})")
            figures[f"store_{kind}_part_kb"] = grown.total() / made / 1000
        database.close()
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
