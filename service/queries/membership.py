"""The condition that a row is among others, as the database answers it soonest where rows are wanted in an order."""

from __future__ import annotations

from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, UnaryExpression, func, select
from sqlalchemy.sql.operators import custom_op

Condition = ColumnElement[bool]
#: SQLite: so many others are looked up first, and then sorted; of more a list is made, in which the rows are looked up
#: as they come in order; of still more each is asked for row by row
FEW, MANY = 5000, 20_000


def among(connection: Connection, key: ColumnElement[Any], others: Select[Any], is_listed: bool = False) -> Condition:
    """The condition that a key is among those selected; ``is_listed``: asking for one of them takes too long."""
    if connection.dialect.name != "sqlite":
        return key.in_(others)
    some = select(func.count()).select_from(others.limit(MANY + 1).subquery())
    count = connection.execute(some).scalar_one()
    if count > MANY and not is_listed:
        return others.where(others.selected_columns[0] == key).exists()
    return (key if count <= FEW else without_index(key)).in_(others)


def without_index(value: ColumnElement[Any]) -> ColumnElement[Any]:
    """The same value, for which SQLite looks in no index."""
    return UnaryExpression(value, operator=custom_op("+"), type_=value.type)
