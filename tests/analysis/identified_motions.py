"""Shipped parts alone, their base parameters, and motions that excite them."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from catalogue_entries import shipped_part
from random_trees import Plain

from substructures import Part, TreeSpec
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.quantities.regressor import regressor

UP = (0, 0, "-9.81")
IN_PLANE = (0, "-9.81", 0)


@cache
def tree(name: str, gravity: tuple[Any, ...] = UP) -> tuple[TreeSpec, dict[str, Part]]:
    spec = {"name": "t", "gravity": list(gravity), "instances": [{"name": "x", "substructure": name}]}
    return TreeSpec.read(spec), {"x": shipped_part(name)}


@cache
def base_of(name: str, gravity: tuple[Any, ...] = UP, drives: tuple[str, ...] = ()) -> BaseParameters:
    return base_parameters(regressor(*tree(name, gravity)), drives)


def motion(n: int, samples: int, seed: int = 0) -> Plain:
    """Finite Fourier series, as they are used for identification."""
    rng, t = np.random.default_rng(seed), np.linspace(0, 10, samples)
    k = np.arange(1, 6)
    angle = 0.2 * np.pi * k[None] * t[:, None]
    a, b = rng.uniform(-0.5, 0.5, (2, 5, n))
    w = 0.2 * np.pi * k[:, None]
    return {
        "q": np.sin(angle) @ a + np.cos(angle) @ b,
        "qd": np.cos(angle) @ (w * a) - np.sin(angle) @ (w * b),
        "qdd": -np.sin(angle) @ (w**2 * a) - np.cos(angle) @ (w**2 * b),
    }
