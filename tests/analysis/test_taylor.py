"""Taylor series by heyoka: agreement with the other integrators, events, inputs, power; what it refuses."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from analysis_models import PERIOD, catalogue_model
from random_trees import Plain, model_of
from simulated import simulated

from substructures import InvalidInput
from substructures.analysis.motion import taylor
from substructures.analysis.simulate import Event, Integrator, Outputs, Table, simulate

pytest.importorskip("heyoka", reason="heyoka is in the test extra")

FINE: Plain = {"relative_tolerance": 1e-14, "absolute_tolerance": 1e-14}


def test_period_of_the_simple_pendulum() -> None:
    """To 1e-12 of the elliptic integral."""
    event = Event("turn", "x.q1'", direction="falling", action="stop")
    request = {"q": [np.pi / 2 - 1e-15], "span": [0, 3], "events": [event], "method": "Taylor", **FINE}
    motion = simulated(catalogue_model("simple-pendulum"), **request)
    assert motion.status == "stopped"
    assert motion.t[-1] == pytest.approx(PERIOD, abs=1e-12)


def test_agreement_with_runge_kutta() -> None:
    """A damped machine with a driving expression and changed parameters, at inner times."""
    model = catalogue_model("furuta-pendulum")
    request: Plain = {"q": [0.1, 0.4], "span": [0.5, 2], "times": [0.7, 1.1, 2], **FINE}
    request["inputs"] = {f"tau.{model.coordinates[0]}": f"sin(4*t)/100 - {model.coordinates[0]}'/50"}
    request["parameters"] = {next(iter(model.parameters)): 0.17}
    one, two = (simulated(model, **request, method=method) for method in ("Taylor", "DOP853"))
    np.testing.assert_allclose(one.q, two.q, atol=1e-11)
    np.testing.assert_allclose(one.series["work"], two.series["work"], atol=1e-11)
    assert one.is_right
    assert one.steps < two.steps
    # parameters are free in what was compiled
    before = taylor._compiled.cache_info().misses
    del request["parameters"]
    simulated(model, **request, method="Taylor")
    assert taylor._compiled.cache_info().misses == before


def test_a_motion_that_cannot_go_on() -> None:
    """s'' = 1 + s'^2 up to t = pi/2."""
    body = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "s"}}
    loads = [{"type": "joint", "coordinate": "s", "force": "1 + s'^2"}]
    model = model_of({"name": "a", "bodies": [body], "loads": loads}, (0, 0, 0))
    motion = simulate(model, [0], (0, 2), integrator=Integrator(method="Taylor"), outputs=Outputs(step=0.1))
    assert motion.status == "failed"
    assert "could not go on" in motion.message
    np.testing.assert_allclose(motion.qd[:15, 0], np.tan(motion.t[:15]), rtol=1e-8)


def test_what_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    model = catalogue_model("simple-pendulum")
    request: Plain = {"q": [0], "span": [0, 1], "method": "Taylor"}
    table = {"tau.x.q1": Table([0, 1], [0, 1])}
    with pytest.raises(InvalidInput, match="no tables") as error:
        simulated(model, **request, inputs=table)
    assert error.value.faults[0].pointer == "/method"
    with pytest.raises(InvalidInput, match="leave 'max_step' out"):
        simulated(model, **request, max_step=0.1)
    monkeypatch.setattr(taylor, "_heyoka", lambda: None)
    with pytest.raises(InvalidInput, match="needs the package"):
        simulated(model, **request)


# takes seconds: a new process imports the whole service
def test_it_is_loaded_by_the_first_motion_that_needs_it() -> None:
    """Loading it takes 86 MB and a quarter of the start of a server; integrators of SciPy take a tenth."""
    program = "import sys, service.app; raise SystemExit(bool({'heyoka', 'scipy.integrate'} & set(sys.modules)))"
    subprocess.run([sys.executable, "-c", program], check=True, timeout=100)
