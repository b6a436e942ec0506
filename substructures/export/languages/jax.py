"""A Python module of JAX functions: to be differentiated, compiled (``jax.jit``), mapped over states (``jax.vmap``)."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

from substructures.export.exported import Exported
from substructures.export.languages.code import indented
from substructures.export.languages.python import CHECK, Python
from substructures.export.reference import Reference
from substructures.printers.language import Listing, Piece

_READ = """
def _vector(name, value, length):
    value = jnp.asarray(value)
    if value.shape != (length,):
        raise ValueError(f"{name} has the shape {value.shape}, ({length},) is needed; jax.vmap maps over states")
    return value
"""


class Jax(Python):
    """JAX; one state for each call. Doubles need ``jax.config.update("jax_enable_x64", True)``."""

    suffix, stem = ".py", "_jax"
    infinity = "jnp.inf"
    executed = "JAX"
    imported, reader, nan = "import jax.numpy as jnp", _READ, 'float("nan")'
    notes = ('For doubles: jax.config.update("jax_enable_x64", True).',)

    def pi(self) -> Piece:
        """The constant of jax.numpy."""
        return Piece("jnp.pi")

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function of jax.numpy."""
        return Piece(f"j{super().call(op, args).text}")

    def define(self, listing: Listing) -> list[str]:
        """A function; one output is an array, several are a dictionary."""
        arguments = ["p=P" if symbol == "p" else symbol for symbol in self.function.arguments]
        body = []
        for vector in self.vectors():
            v = vector.symbol
            body.append("t = jnp.asarray(t)" if v == "t" else f"{v} = _vector({v!r}, {v}, {len(vector)})")
        body += [f"{name} = {element}" for name, element in self.named(self.texts(listing))]
        body += [f"t{n} = {text}" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            body += self._output(output, array.shape, listing)
        return [f"def {self.called}({', '.join(arguments)}):", *indented([*body, self.returned()])]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A script that exits with 1 where a value is not the reference's."""
        lines = ["import sys", "", "import jax", "import jax.numpy as jnp", ""]
        lines += [
            'jax.config.update("jax_enable_x64", True)',
            f"import {exported.name}_jax",
            "",
            "wrong = False",
            *CHECK,
        ]
        for each in reference:
            given = [
                repr(values[0]) if s == "t" else f"jnp.array({list(values)!r})" for s, values in each.arguments.items()
            ]
            lines += ["", f"y = jax.jit({exported.name}_jax.{each.called})({', '.join(given)})"]
            names = list(exported.functions[each.number].program.outputs)
            for check in each.checks:
                y = f"y[{names[check.output]!a}]" if len(names) > 1 else "y"
                found = f"jnp.sum({y})" if check.is_sum else f"{y}[{check.index!r}]"
                lines.append(f"wrong |= differs({found}, {check.value!r}, {check.limit!r}, {each.called!r})")
        return {
            f"{exported.name}_jax_selftest.py": "\n".join([*lines, "", 'sys.exit(1 if wrong else print("ok"))', ""])
        }

    def _output(self, output: str, shape: tuple[int, ...], listing: Listing) -> list[str]:
        """The elements that are not zero, each a variable, and the array of all."""
        pairs, v = self.pairs(output, listing), self.variables[output]
        lines = [f"{element} = {text}" for element, text in pairs]
        known = {element for element, _ in pairs}
        places = [self.place(v, shape, index) for index in product(*map(range, shape))]
        every = [place if place in known else "0.0" for place in places]
        if not shape:
            return [*lines, f"{v} = jnp.asarray({every[0]}, dtype=float)"]
        return [
            *lines,
            f"{v} = jnp.array([",
            *(f"    {each}," for each in every),
            f"], dtype=float).reshape({shape!r})",
        ]

    def place(self, variable: str, array: object, index: tuple[int, ...]) -> str:  # noqa: ARG002 - of the interface
        """The variable of an element."""
        return "_".join([variable, "e", *map(str, index)])
