"""The condition that a row is among others, as the database answers it soonest where rows are wanted in an order."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, UnaryExpression, any_, func, select
from sqlalchemy.sql.operators import custom_op

Condition = ColumnElement[bool]
#: so many others are looked up first, and then sorted; of more SQLite makes a list, in which the rows are looked up as
#: they come in order; of still more each is asked for row by row
FEW, MANY = 2000, 15_000


@dataclass(eq=False)
class Membership:
    """``key`` is among ``others``, a query of one column. ``is_listed``: asking for one of them takes too long;
    ``in_order``: SQLite finds them in their order, each once; ``times``: that many times FEW are few, where no order of
    results has them together.
    """

    key: ColumnElement[Any]
    others: Select[Any]
    is_listed: bool = False
    in_order: bool = False
    times: int = 1
    _are_counted: dict[int, bool] = field(default_factory=dict)

    def is_common(self, connection: Connection) -> bool:
        """Whether there are more than are looked up first, and then sorted."""
        return self._are_more(connection, self.times * FEW)

    def condition(self, connection: Connection) -> Condition:
        """It, of rows that are wanted in an order."""
        is_few = not self.is_common(connection)
        if connection.dialect.name != "sqlite":
            # PostgreSQL would walk through all rows in their order for the sake of a limit, however few are wanted
            return self.key == any_(func.array(self.others.scalar_subquery())) if is_few else self.key.in_(self.others)
        if is_few:
            return self.key.in_(self.others)
        if not self.is_listed and self._are_more(connection, MANY):
            return self.others.where(self.others.selected_columns[0] == self.key).exists()
        return without_index(self.key).in_(self.others)

    def _are_more(self, connection: Connection, than: int) -> bool:
        if than not in self._are_counted:
            counted = select(func.count()).select_from(self.others.limit(than + 1).subquery())
            self._are_counted[than] = connection.execute(counted).scalar_one() > than
        return self._are_counted[than]


def scanned(connection: Connection, value: ColumnElement[Any]) -> ColumnElement[Any]:
    """A value that SQLite does better not to look for in an index."""
    return without_index(value) if connection.dialect.name == "sqlite" else value


def without_index(value: ColumnElement[Any]) -> ColumnElement[Any]:
    """The same value, for which SQLite looks in no index."""
    return UnaryExpression(value, operator=custom_op("+"), type_=value.type)
