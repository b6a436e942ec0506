"""Analyses in numbers, by the names of their endpoints: the body of a request in, a result out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from service.models.results import DRAWN, JSON, PLAIN, TRAJECTORY
from substructures.late import Table
from substructures.tree.given.ties import require_untied

if TYPE_CHECKING:  # what an analysis needs is imported when it is first asked for
    from service.models.numbers.analysis import Analysis
    from substructures.tree.model import Model


@dataclass(frozen=True)
class Offered:
    """What is known of an analysis before it is imported: its ``module`` here, the name of the ``schema`` of its body,
    what it is (``text``), and what its result can be (``media``)."""

    module: str
    schema: str
    text: str
    media: tuple[str, ...] = PLAIN


OFFERED = {
    "abbreviations": Offered(
        "abbreviations",
        "AbbreviationRequest",
        "A quantity with what is negligible over given ranges left out, and a proven bound of the error",
        (JSON,),
    ),
    "simulations": Offered(
        "motions",
        "AnySimulationRequest",
        "The motion from a start, with the drift of all first integrals as judge",
        TRAJECTORY,
    ),
    "ensembles": Offered(
        "ensembles",
        "EnsembleRequest",
        "Motions from many starts and with many parameters, each with its verdict",
    ),
    "sensitivities": Offered(
        "motions",
        "SensitivityRequest",
        "A motion and its derivatives by parameters and by the start",
        TRAJECTORY,
    ),
    "periodic-orbits": Offered(
        "orbits",
        "PeriodicOrbitRequest",
        "Motions that come back, with Floquet's multipliers and their stability",
    ),
    "poincare-sections": Offered(
        "orbits",
        "PoincareSectionRequest",
        "The states in which a motion crosses a surface in one direction",
        TRAJECTORY,
    ),
    "lyapunov-exponents": Offered(
        "orbits",
        "LyapunovRequest",
        "How fast neighbouring motions part: whether a motion is chaotic, and how sure",
    ),
    "linearisations": Offered(
        "stability",
        "LinearisationRequest",
        "Perturbation equations M, D, K, F and state space A, B, C, D about states; modes and stability at "
        "equilibria; of closed loops in independent coordinates, about one state; with velocity constraints about"
        " one motion",
    ),
    "frequency-responses": Offered(
        "stability",
        "FrequencyResponseRequest",
        "What outputs do where inputs oscillate: G(i w) of a tree linearised about a state, with its poles",
        DRAWN,
    ),
    "regulators": Offered(
        "stability",
        "RegulatorRequest",
        "Linear quadratic regulator about an equilibrium, with what inputs reach and weights see",
    ),
    "equilibria": Offered(
        "stability",
        "EquilibriaRequest",
        "All equilibria that are found, each with its vibrations and stability; also of closed loops",
    ),
    "steady-motions": Offered(
        "stability",
        "SteadyMotionsRequest",
        "Steady motions: cyclic coordinates at constant rates, all others still; each with its stability and why;"
        " families over a parameter, a rate or a momentum with their bifurcations",
        DRAWN,
    ),
    "root-loci": Offered("stability", "RootLocusRequest", "Eigenvalues of an equilibrium over a parameter", DRAWN),
    "curvatures": Offered("geometry", "CurvatureRequest", "Riemann's tensor of the configuration space, Ricci, scalar"),
    "cost-gradients": Offered(
        "control",
        "GradientRequest",
        "The cost of a motion under given controls and its gradient by the adjoint",
        TRAJECTORY,
    ),
    "optimal-controls": Offered(
        "control",
        "OptimalControlRequest",
        "Controls of least cost, judged by the necessary conditions",
        TRAJECTORY,
    ),
    "optimal-parameters": Offered(
        "optimum",
        "OptimalParametersRequest",
        "Parameters that make an expression in columns least, within bounds and conditions",
    ),
    "loop-states": Offered(
        "loops",
        "LoopRequest",
        "A consistent state of closed loops: mobility, redundancy, accelerations, reaction forces",
    ),
    "reduced-equations": Offered(
        "loops",
        "ReducedRequest",
        "Equations of motion of closed loops in independent coordinates: metric, Christoffel symbols, forces",
    ),
    "excitations": Offered(
        "identification",
        "ExcitationRequest",
        "How well a motion excites the base inertial parameters",
    ),
    "identifications": Offered(
        "identification",
        "IdentificationRequest",
        "Base inertial parameters from a measured motion",
    ),
}


def analysis_of(name: str, model: Model) -> Analysis:
    """The analysis of a model. Raises InvalidDocument where it would ignore velocity constraints of the tree."""
    require_untied(model, name)
    return ANALYSES[name]


ANALYSES: Table[Analysis] = Table(
    "ANALYSES", {name: f"{__name__}.{offered.module}" for name, offered in OFFERED.items()}
)
