"""Frequency response of a linearised tree: what outputs do where inputs oscillate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.arguments import NumberOrExpression, reals
from substructures.analysis.given import StateArray
from substructures.analysis.stability.linear_system import eigenvalues, linear_system
from substructures.array import Array, ComplexArray
from substructures.errors import InvalidArgument
from substructures.tree.model import Model

#: of frequencies where none are given, and how far they reach beyond those of the poles
COUNT, BEYOND = 200, 10.0
#: what rounding leaves between a frequency and a pole that it is, relative
ROUNDED = 1e-14


@dataclass(frozen=True, repr=False)
class FrequencyResponse:
    """``response`` (K, k, m), y = G(i w) u of ``outputs`` k and ``inputs`` m at ``frequencies`` (K,) [rad/s], with the
    ``poles`` (2r,) [1/s] of the system. ``status`` ``failed``: ``message`` says why.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    frequencies: Array
    response: ComplexArray
    poles: ComplexArray
    status: str = "finished"
    message: str = ""

    def __repr__(self) -> str:
        sizes = f"inputs={len(self.inputs)}, outputs={len(self.outputs)}, frequencies={len(self.frequencies)}"
        return f"FrequencyResponse({sizes})\n{self.message or self.status}"

    @property
    def magnitude(self) -> Array:
        """|G| (K, k, m)."""
        return np.abs(self.response)

    @property
    def phase(self) -> Array:
        """arg G (K, k, m) [rad], without jumps along the frequencies."""
        return np.unwrap(np.angle(self.response), axis=0)


def frequency_response(
    model: Model,
    q: StateArray,
    *,
    frequencies: Sequence[float] | Array | None = None,
    outputs: Mapping[str, NumberOrExpression] | None = None,
    **point: Any,
) -> FrequencyResponse:
    """G(i w) = C (i w - A)^-1 B + D of a tree that is linearised about one state, on its closures and constraints.

    ``frequencies`` [rad/s]: by default from a tenth of the slowest pole to ten times the fastest. ``outputs``: y by
    name, by default all coordinates, of ball joints their places and quaternions; ``point``: further arguments of
    :func:`linearise`. Raises as that.

    >>> from substructures import couple, derive, frequency_response
    >>> tree = {"name": "clock", "gravity": [0, 0, -10]}
    >>> tree["instances"] = [{"name": "p", "substructure": "simple-pendulum"}]
    >>> model = couple(tree, {"p": derive("simple-pendulum")})
    >>> float(frequency_response(model, [0], frequencies=[0.0]).magnitude[0, 0, 0])
    0.1
    """
    chosen = outputs or {name: name for name in model.positions}
    system = linear_system(model, q, point, chosen, "frequency-responses")
    poles = eigenvalues(system.A)
    w = _frequencies(frequencies, poles)
    shape = (len(w), len(system.outputs), len(system.inputs))
    response = np.full(shape, np.nan + 0j)
    one = np.eye(len(system.A))
    nearest = np.abs(1j * w[:, None] - poles[None, :]).min(axis=1, initial=np.inf)
    for k, each in enumerate(w):
        try:
            if nearest[k] <= ROUNDED * each:
                raise np.linalg.LinAlgError
            response[k] = system.C @ np.linalg.solve(1j * each * one - system.A, system.B) + system.Dy
        except np.linalg.LinAlgError:
            message = f"{each:.6g} rad/s is a pole: the response is infinite there; take other frequencies"
            return FrequencyResponse(system.inputs, system.outputs, w, response, poles, "failed", message)
    return FrequencyResponse(system.inputs, system.outputs, w, response, poles)


def _frequencies(given: Sequence[float] | Array | None, poles: ComplexArray) -> Array:
    if given is None:
        sizes = np.abs(poles)[np.abs(poles) > 1e-6 * np.abs(poles).max(initial=0)]
        slowest, fastest = (float(sizes.min()), float(sizes.max())) if len(sizes) else (1.0, 1.0)
        return np.geomspace(slowest / BEYOND, fastest * BEYOND, COUNT)
    found = np.array(reals(given, "/frequencies"))
    if not len(found) or (found < 0).any():
        raise InvalidArgument.at("/frequencies", "out-of-range", "a list of frequencies in rad/s that are not negative")
    return found
