"""Mechanisms whose equations stand in textbooks, and their formulas."""

from __future__ import annotations

from functools import cache

from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import BLADE, FORWARD, sleigh

from substructures import Model, Program, catalogue
from substructures.analysis.equations.curvature import curvature
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.routh import routh
from substructures.quantities.formulas import derived


def top() -> Model:
    """A symmetric top with its fixed point below the mass centre; moments about the mass centre."""
    units = {"m": "kg", "l": "m", "A": "kg*m^2", "C": "kg*m^2"}
    place = {"position": [0, 0, 0]}
    joints: list[Plain] = [{"coordinate": "psi"}, {"coordinate": "theta", "placement": place, "axis": [1, 0, 0]}]
    joints.append({"coordinate": "phi"})
    names = ("outer", "inner", "top")
    bodies: list[Plain] = [
        {"name": name, "parent": names[k - 1] if k else "base", "joint": {"type": "revolute"} | joint}
        for k, (name, joint) in enumerate(zip(names, joints, strict=True))
    ]
    bodies[-1] |= {"mass": "m", "com": [0, 0, "l"], "inertia": {"xx": "A", "yy": "A", "zz": "C"}}
    part = {"name": "top", "parameters": {k: {"value": 1, "unit": u} for k, u in units.items()}, "bodies": bodies}
    return tree({"top": part})


def tree(parts: Plain) -> Model:
    gravity = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    return tree_model(gravity | {"instances": [{"name": "x", "substructure": name} for name in parts]}, parts)


@cache
def program(model: str, output: str) -> Program:
    """One output of an entry of the catalogue, or of a body of its own."""
    if model == "sleigh":
        return quasi_velocity_equations(sleigh(), [BLADE], velocities=FORWARD).program.select([output])
    if model == "top":
        return routh(top()).program.select([output])
    found = top() if model == "symmetric-top" else tree({model: catalogue.load(model)})
    if output in ("forward_dynamics", "hamiltonian"):
        return derived(found, output).select([output])
    if output == "energy" or "momentum" in output:
        return first_integrals(found).program.select([output])
    if output == "scalar_curvature":
        return curvature(found).select([output])
    return found.program.select([output])
