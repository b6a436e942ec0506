"""Where exact numbers stand in sums, products and negatives, and roots in products: what makes terms collect."""

from __future__ import annotations

from typing import Any, Protocol, Self, TypeVar


class Node(Protocol):
    """What is looked at of an expression (:class:`substructures.expr.graph.Expr`)."""

    @property
    def op(self) -> str:
        """Name of the operation."""

    @property
    def args(self) -> tuple[Self, ...]:
        """Operands."""

    @property
    def value(self) -> Any:
        """Of a number or symbol."""

    @property
    def fp(self) -> int:
        """Fingerprint."""

    @property
    def is_number(self) -> bool:
        """Whether it is an exact number."""

    def __neg__(self) -> Self: ...
    def __sub__(self, other: Self) -> Self: ...
    def __mul__(self, other: Self) -> Self: ...


N = TypeVar("N", bound=Node)


def has_number(x: Node) -> bool:
    """An exact number, or a product, sum or negative with one."""
    if x.op == "neg":
        x = x.args[0]
    return x.is_number or (x.op in ("mul", "add", "sub") and (x.args[0].is_number or x.args[1].is_number))


def is_combination(x: Node) -> bool:
    """A number, or a sum of multiples of symbols and numbers."""
    stack = [x]
    while stack:
        node = stack.pop()
        if node.op in ("add", "sub", "neg"):
            stack += node.args
        elif node.op == "mul" and node.args[0].is_number:
            stack.append(node.args[1])
        elif node.args and not (node.op == "acos" and node.args[0].is_number):
            return False
    return True


def coefficient(x: N) -> tuple[Any, N]:
    """(c, y) with x = c y."""
    sign = 1
    if x.op == "neg":
        sign, x = -1, x.args[0]
    return (sign * x.args[0].value, x.args[1]) if x.op == "mul" and x.args[0].is_number else (sign, x)


def constant(x: N) -> tuple[N, Any]:
    """(y, c) with x = y + c."""
    if x.is_number:
        return x - x, x.value
    if x.op == "neg":
        rest, number = constant(x.args[0])
        return -rest, -number
    if x.op in ("add", "sub"):
        a, b = x.args
        sign = 1 if x.op == "add" else -1
        if b.is_number:
            return a, sign * b.value
        if a.is_number:
            return (b if sign > 0 else -b), a.value
    return x, 0


def square_of_root(a: N, b: N) -> N | None:
    """sqrt(x) sqrt(x) = x, also with one of them inside a product."""
    if a.op != "sqrt":
        a, b = b, a
    if a is b:
        return a.args[0]
    if b.op == "mul" and a in b.args:
        return a.args[0] * (b.args[1] if b.args[0] is a else b.args[0])
    return None
