"""Linearisation of a tree without closures: M, D, K, A, B, C, D at a state or along a trajectory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.analysis.equations.formulas import inputs_of, require_tree
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.stability.linearisation import (
    MATRICES,
    Linearisation,
    LinearisationRequest,
    chosen_inputs,
    fault_of,
    has_potential,
    is_small,
    output_matrices,
)
from substructures.analysis.stability.vibrations import first_order, modes, stability
from substructures.array import Array
from substructures.documents import read_model
from substructures.expr.interpret import interpret_in_blocks
from substructures.mechanics.accelerations import cholesky_solve
from substructures.quantities.states import States, read_states, symbol_values
from substructures.tree.model import Model

DYNAMICS = ("metric", "bias", "forces")


def linearise_tree(model: Model, request: Mapping[str, Any]) -> Linearisation:
    """Perturbation equations and state-space matrices about states of a tree; ``request``: see LinearisationRequest.

    ``q`` (n,) or (N, n): arrays of the result have the leading axis N in the second case. Raises InvalidDocument
    (pointers; ``not-smooth`` for forces without derivative; ``has-closures``) and MissingValue.
    """
    require_tree(model)
    read = read_model(LinearisationRequest, request)
    states = read_states(model, {"q": read.q, "qd": read.qd, "qdd": read.qdd}, None)
    chosen = chosen_inputs(model, read)
    source = perturbation(model)
    given = {"parameters": read.parameters, "inputs": read.inputs, "t": read.t}
    values = symbol_values(model, given, states, DYNAMICS)
    qdd = _accelerations(model, values, states)
    values |= {f"{name}''": qdd[:, a] for a, name in enumerate(model.coordinates)}
    found = interpret_in_blocks(source, values, list(MATRICES), len(qdd))
    found["input"] = found["input"][:, :, [inputs_of(model).index(name) for name in chosen]]
    by_output = output_matrices(model, read, chosen, values, len(qdd))
    result = _assembled(model, chosen, tuple(read.outputs), found, by_output, qdd)
    message = fault_of(model.coordinates, result.qdd, result.D, result.K)
    if message:
        result = replace(result, status="failed", message=message)
    if not states.single:
        return result
    return _at_equilibrium(model, read, states, _single(result))


def _accelerations(model: Model, values: Mapping[str, Any], states: States) -> Array:
    if states.qdd is not None:
        return np.array(states.qdd)
    found = interpret_in_blocks(model.program, values, list(DYNAMICS), len(states.q))
    return cholesky_solve(found["metric"], found["forces"] - found["bias"])


def _assembled(
    model: Model,
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    found: Mapping[str, Array],
    by_output: tuple[Array, Array],
    qdd: Array,
) -> Linearisation:
    M, D, K, F = (found[name] for name in ("metric", "damping", "stiffness", "input"))
    pairs = []
    for m, d, k, f in zip(M, D, K, F, strict=True):
        try:
            pairs.append((first_order(m, d, k), np.vstack([np.zeros_like(f), np.linalg.solve(m, f)])))
        except np.linalg.LinAlgError:
            n = len(m)
            pairs.append((np.full((2 * n, 2 * n), np.nan), np.full((2 * n, f.shape[1]), np.nan)))
    A, B = np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])
    return Linearisation(model.coordinates, inputs, outputs, M, D, K, F, A, B, *by_output, qdd, found["residual"])


def _single(result: Linearisation) -> Linearisation:
    names = ("M", "D", "K", "F", "A", "B", "C", "Dy", "qdd", "residual")
    return replace(result, **{name: getattr(result, name)[0] for name in names})


def _at_equilibrium(model: Model, read: LinearisationRequest, states: States, result: Linearisation) -> Linearisation:
    still = not states.qd.any() and result.status == "finished"
    if not still or not is_small(result.qdd, result.K, result.M):
        return result
    if not is_small(np.linalg.solve(result.M, result.residual), result.K, result.M):
        return result
    found = modes(result.M, result.D, result.K)
    return replace(result, modes=found, stability=stability(found, result.D, result.K, has_potential(model, read)))
