"""Multibody dynamics from stored formulas that couple (P. Maisser's algebraised Lagrange formalism).

The equations of motion of a tree of rigid bodies, g_ab q''^b + Gamma_abc q'^b q'^c = Q_a, come about in five steps:

=============  ======================  ===========================================================================
step           folder                  what is there
=============  ======================  ===========================================================================
definition     part.definition         what a mechanism is, as a document: bodies, joints, ports, loads, parameters
part           part                    its formulas, derived once (part.derive) and stored: U_ka and Omega_ka by
                                       mechanics.kinematics, own g_ab and Gamma_abc by mechanics.composite_form,
                                       and what couples them to any host; all outputs are listed in part.formulas
tree           tree                    parts on ports of parts: tree.coupling makes g_ab, Gamma_abc and the gravity
                                       forces of the whole out of the stored formulas; the outputs of a model are
                                       listed in tree.model_outputs
quantities     quantities              what a model can be asked, as formulas and as numbers of one state or many
analysis       analysis                what follows: first integrals, motion, closed loops, stability, control
many at once   ensembles, sweeps       motions from many starts; numbers of many combinations of parts
=============  ======================  ===========================================================================

Where the symbols of the notation (notation.md) are made:

=============  ================================================================================================
U, Omega       partial velocities: mechanics.kinematics (base_functions), carried to hosts in tree.coupling
g_ab           metric, d^2 T / dq'^a dq'^b: mechanics.evaluation_frames (metric), of parallel axes
               mechanics.parallel_axes
Gamma_abc      = 1/2 (d_b g_ac + d_c g_ab - d_a g_bc), without differentiating: the same modules (christoffel)
N_ai           dq^a / dq^i of joints that relations move (gears, mimic joints): mechanics.ratios, part.relations
g_a0, ...      what given motions of coordinates make of these (Gamma_ab0, Gamma_a00, T_0, ...): tree.given.driven
ignored_rates  velocities that given momenta of cyclic coordinates make (Routh's reduced system): tree.given.ignored
Q_a            = sum over bodies K . u_a + M . Omega_a, springs, dampers and actuators: one law a file in loads
               (loads.kinds), summed in part.forces.applied_forces (own forces of a part), tree.coupling (gravity, and
               wrenches on what others carry) and tree.forces.loads (between parts)
=============  ================================================================================================

What leaves as functions of other languages is made by export, on one calling convention (export.interface). Beside
them stands certificate: what every stored formula has to be, computed from the documents alone
(certificate.md). Below all of them: printers (programs as text), textbook (formulas as a person writes them), compile
(programs as machine code), mechanics (one recursion over any scalar), expr (formulas as graphs and programs),
documents (JSON and YAML with exact numbers and their units). Further: abbreviation (formulas
without what is negligible, and proof of how wrong that is), catalogue (mechanisms with sources), formats
(npz, Arrow), client (of the HTTP service).

>>> from substructures import couple, derive, simulate
>>> tree = {"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
>>> model = couple(tree, {"p": derive("simple-pendulum")})
>>> simulate(model, [0.5], (0, 1)).is_right
True
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from substructures.late import names_in

if TYPE_CHECKING:  # what is imported when it is first asked for: see _WHERE
    from substructures import catalogue
    from substructures.abbreviation.abbreviate import abbreviate
    from substructures.analysis.control.cost_gradient import cost_gradient
    from substructures.analysis.control.demands import Demands, End
    from substructures.analysis.control.optimal_control import optimal_control
    from substructures.analysis.control.problem import ControlProblem, Cost
    from substructures.analysis.equations.first_integrals import first_integrals
    from substructures.analysis.motion.parameter_sensitivity import sensitivities
    from substructures.analysis.motion.problems.outputs import Outputs, SensitivityOutputs
    from substructures.analysis.simulate import (
        Closed,
        ClosedMotion,
        ConstrainedMotion,
        Contact,
        Event,
        FixedStep,
        Geodesic,
        Integrator,
        KnifeEdge,
        Linear,
        Rolling,
        Table,
        TreeMotion,
        simulate,
    )
    from substructures.analysis.stability.equilibria import equilibria
    from substructures.analysis.stability.frequency_response import frequency_response
    from substructures.analysis.stability.linearise import linearise
    from substructures.analysis.stability.regulator import regulator
    from substructures.analysis.stability.steady_motions import steady_motions
    from substructures.ensembles.ensemble import simulate_ensemble
    from substructures.ensembles.motion_column import MotionColumn
    from substructures.errors import (
        Fault,
        InvalidArgument,
        InvalidDocument,
        InvalidInput,
        InvalidProgram,
        MissingValue,
        SubstructuresError,
        TooLarge,
    )
    from substructures.export import render
    from substructures.expr.program import Program
    from substructures.interchange.symbolic.equations import linearizer, symbolic_system
    from substructures.interchange.symbolic.expressions import to_sympy
    from substructures.interchange.symbolic.systems import tree_of_system
    from substructures.interchange.symbolic.texts import from_sympy
    from substructures.part.definition import Definition
    from substructures.part.derive import derive
    from substructures.part.part import Formula, Part
    from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
    from substructures.tree.couple import couple
    from substructures.tree.document import Instance, TreeSpec, read_instance
    from substructures.tree.model import Model

__all__ = [
    "Closed",
    "ClosedMotion",
    "ConstrainedMotion",
    "Contact",
    "ControlProblem",
    "Cost",
    "Definition",
    "Demands",
    "End",
    "EvaluationOptions",
    "Event",
    "Fault",
    "FixedStep",
    "Formula",
    "Geodesic",
    "Instance",
    "Integrator",
    "InvalidArgument",
    "InvalidDocument",
    "InvalidInput",
    "InvalidProgram",
    "KnifeEdge",
    "Linear",
    "MissingValue",
    "Model",
    "MotionColumn",
    "Outputs",
    "Part",
    "Program",
    "Rolling",
    "SensitivityOutputs",
    "SubstructuresError",
    "Table",
    "TooLarge",
    "TreeMotion",
    "TreeSpec",
    "__version__",
    "abbreviate",
    "catalogue",
    "cost_gradient",
    "couple",
    "derive",
    "equilibria",
    "evaluate",
    "first_integrals",
    "frequency_response",
    "from_sympy",
    "linearise",
    "linearizer",
    "optimal_control",
    "read_instance",
    "regulator",
    "render",
    "sensitivities",
    "simulate",
    "simulate_ensemble",
    "steady_motions",
    "symbolic_system",
    "to_sympy",
    "tree_of_system",
]

__version__: str

_WHERE = {
    "substructures.abbreviation.abbreviate": ("abbreviate",),
    "substructures.analysis.control.cost_gradient": ("cost_gradient",),
    "substructures.analysis.control.demands": ("Demands", "End"),
    "substructures.analysis.control.optimal_control": ("optimal_control",),
    "substructures.analysis.control.problem": ("ControlProblem", "Cost"),
    "substructures.analysis.equations.first_integrals": ("first_integrals",),
    "substructures.analysis.motion.parameter_sensitivity": ("sensitivities",),
    "substructures.analysis.motion.problems.outputs": ("Outputs", "SensitivityOutputs"),
    "substructures.analysis.simulate": (
        *("Closed", "ClosedMotion", "ConstrainedMotion", "Contact", "Event", "FixedStep", "Geodesic"),
        *("Integrator", "KnifeEdge", "Linear", "Rolling", "Table", "TreeMotion", "simulate"),
    ),
    "substructures.analysis.stability.equilibria": ("equilibria",),
    "substructures.analysis.stability.frequency_response": ("frequency_response",),
    "substructures.analysis.stability.linearise": ("linearise",),
    "substructures.analysis.stability.regulator": ("regulator",),
    "substructures.analysis.stability.steady_motions": ("steady_motions",),
    "substructures.ensembles.motion_column": ("MotionColumn",),
    "substructures.ensembles.ensemble": ("simulate_ensemble",),
    "substructures.errors": (
        *("Fault", "InvalidArgument", "InvalidDocument", "InvalidInput", "InvalidProgram", "MissingValue"),
        *("SubstructuresError", "TooLarge"),
    ),
    "substructures.export": ("render",),
    "substructures.expr.program": ("Program",),
    "substructures.part.definition": ("Definition",),
    "substructures.part.derive": ("derive",),
    "substructures.part.part": ("Formula", "Part"),
    "substructures.quantities.numbers.evaluation": ("EvaluationOptions", "evaluate"),
    "substructures.interchange.symbolic.equations": ("linearizer", "symbolic_system"),
    "substructures.interchange.symbolic.expressions": ("to_sympy",),
    "substructures.interchange.symbolic.systems": ("tree_of_system",),
    "substructures.interchange.symbolic.texts": ("from_sympy",),
    "substructures.tree.document": ("Instance", "TreeSpec", "read_instance"),
    "substructures.tree.couple": ("couple",),
    "substructures.tree.model": ("Model",),
}
_named = names_in(__name__, _WHERE)


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first asked for: a client of the service does not wait for SciPy."""
    if name == "__version__":
        value: Any = import_module("importlib.metadata").version("substructures")
    elif name == "catalogue":
        value = import_module("substructures.catalogue")
    else:
        return _named(name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
