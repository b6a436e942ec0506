"""What the analysis derives can be stored, printed in every language, and read in textbooks."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from analysis_models import catalogue_model

from substructures import Model, Program
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.perturbation import perturbation, state_space
from substructures.analysis.equations.routh import routh
from substructures.analysis.motion.parameter_sensitivity import sensitivity_formulas
from substructures.analysis.motion.right_hand_side import forward_dynamics
from substructures.export import FORMATS, Interface, render

PROGRAMS: dict[str, Callable[[Model], Program]] = {
    "first integrals": lambda m: first_integrals(m).program,
    "Routh": lambda m: routh(m).program,
    "perturbation": perturbation,
    "state space": lambda m: state_space(m, ["x.q0 + x.q1'", "tau.x.q0"]),
    "sensitivities": lambda m: sensitivity_formulas(m, list(m.parameters)),
    "forward dynamics": forward_dynamics,
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_stored_and_printed(name: str) -> None:
    program = PROGRAMS[name](catalogue_model("cart-pendulum"))
    assert Program.from_bytes(program.to_bytes()) == program
    assert all(s.unit for s in program.symbols)
    interface = Interface.of_symbols(program.symbols)
    for language in FORMATS:
        assert render(program, language, interface=interface)
    assert render(program, "text", form="expanded")


def test_cart_and_pendulum_reads_as_in_textbooks() -> None:
    """Momentum of the cart, and Routh's amended potential p^2/(2 (m0 + m1)) + m1 g l cos q."""
    model = catalogue_model("cart-pendulum")
    text = render(first_integrals(model).program, "text", form="expanded")
    assert "linear_momentum.x = m0*q0' + m1*q0' - l0*m1*q1'*cos(q1)" in text
    text = render(routh(model).program, "text", form="expanded")
    assert "cyclic_velocities[1] = (p_0 + l0*m1*q1'*cos(q1))/(m0 + m1)" in text
    assert "forces[1] = 9.81*l0*m1*sin(q1)" in text
