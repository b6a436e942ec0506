"""Every quantity over HTTP: regressor and directional derivatives, as numbers and as formulas; parameter sweeps."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import io
import threading
from typing import Any

import numpy as np
import pytest
from damaged import damages
from fastapi.testclient import TestClient

from service.models import binding
from service.store.store import Store
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.quantities.quantity import QUANTITIES

from .one_store import double

__all__ = ["double"]  # a fixture

URL = "/v1/trees/cell/evaluations"
RNG = np.random.default_rng(3)
Q, QD, QDD, DQ, DQD, DQDD = (RNG.uniform(-1, 1, (4, 2)).round(3).tolist() for _ in range(6))
TAU = [0.1, 0.2, -0.3, 0.4]
STATES: dict[str, Any] = {"q": Q, "qd": QD, "qdd": QDD, "inputs": {"tau.arm.q": TAU}}
ALONG: dict[str, Any] = {"q": DQ, "qd": DQD, "qdd": DQDD, "inputs": {"tau.hand.q": 2}}


def ask(client: TestClient, quantities: list[str], **request: Any) -> dict[str, Any]:
    answer = client.post(URL, json={"quantities": quantities, **STATES, **request})
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = answer.json()
    assert result["failures"] == []
    return result


def test_regressor_times_parameters_is_inverse_dynamics(double: TestClient) -> None:
    """Without what the actuators give."""
    answer = ask(double, ["regressor", "inertial_parameters", "inverse_dynamics"], inputs={})
    Y, pi = np.array(answer["regressor"]), np.array(answer["inertial_parameters"])
    assert Y.shape == (4, 2, 20)
    assert pi.shape == (4, 20)
    names, units = answer["columns"]["names"], answer["columns"]["units"]
    assert (names[0], units[0], names[19], units[19]) == ("arm.rod.m", "kg", "hand.rod.Jyz", "kg m^2")
    np.testing.assert_allclose(np.einsum("nai,ni->na", Y, pi), answer["inverse_dynamics"], atol=1e-12)


def test_forward_dynamics_inverts_inverse_dynamics(double: TestClient) -> None:
    needed = np.array(ask(double, ["inverse_dynamics"], inputs={})["inverse_dynamics"])
    tau = {"tau.arm.q": needed[:, 0].tolist(), "tau.hand.q": needed[:, 1].tolist()}
    found = ask(double, ["forward_dynamics"], inputs=tau)["forward_dynamics"]
    np.testing.assert_allclose(found, QDD, atol=1e-10)


@pytest.mark.parametrize("quantity", ["inverse_dynamics", "forward_dynamics"])
def test_derivatives_against_differences(double: TestClient, quantity: str) -> None:
    found = ask(double, [f"{quantity}_derivative"], along=ALONG)[f"{quantity}_derivative"]
    h, values = 1e-5, []
    for sign in (1, -1):
        moved = {key: (np.array(STATES[key]) + sign * h * np.array(ALONG[key])).tolist() for key in ("q", "qd", "qdd")}
        inputs = {"tau.arm.q": TAU, "tau.hand.q": sign * h * 2}
        values.append(np.array(ask(double, [quantity], **moved, inputs=inputs)[quantity]))
    np.testing.assert_allclose(found, (values[0] - values[1]) / (2 * h), atol=1e-6)


def test_one_direction_for_all_states_and_npz(double: TestClient) -> None:
    names = ["forward_dynamics_derivative", "inverse_dynamics_derivative", "regressor"]
    expected = ask(double, names, along={"q": [1, 0], "inputs": {"tau.arm.q": TAU}})
    stream = io.BytesIO()
    members = {
        "along.q": np.array([1.0, 0]),
        "along.inputs.tau.arm.q": np.array(TAU),
        "inputs.tau.arm.q": np.array(TAU),
    }
    states = {key: np.array(STATES[key]) for key in ("q", "qd", "qdd")}
    np.savez(stream, quantities=np.array(names), **states, **members)
    answer = double.post(URL, content=stream.getvalue(), headers={"Content-Type": "application/x-npz"})
    assert answer.status_code == 200, answer.text
    found = np.load(io.BytesIO(answer.content), allow_pickle=False)
    for name in names:
        # the kernel may have been compiled in between: its last bits are not those of the interpreter
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-12, atol=1e-12)
    assert found["columns.names"].tolist() == expected["columns"]["names"]


@pytest.mark.parametrize(
    ("more", "pointer"),
    [
        ({}, "/along"),
        ({"along": {"q": [1]}}, "/along/q"),
        ({"along": {"q": {"arm.q": 1}}}, "/along/q"),
        ({"along": {"qd": [["x", 1]]}}, "/along/qd/0/0"),
        ({"along": {"inputs": {"tau.leg": 1}}}, "/along/inputs/tau.leg"),
        ({"along": {"speed": 1}}, "/along/speed"),
        ({"along": {"q": [1, 0]}, "qdd": None}, "/qdd"),
    ],
)
def test_refused_directions(double: TestClient, more: dict[str, Any], pointer: str) -> None:
    answer = double.post(URL, json={"quantities": ["inverse_dynamics_derivative"], **STATES, **more})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer


def test_an_array_and_an_object_of_one_name(double: TestClient) -> None:
    stream = io.BytesIO()
    np.savez(stream, quantities=np.array(["metric"]), q=np.zeros(2), along=np.zeros(2), **{"along.q": np.zeros(2)})
    answer = double.post(URL, content=stream.getvalue(), headers={"Content-Type": "application/x-npz"})
    assert answer.status_code == 422, answer.text
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [("/along.q", "given-twice")]


@pytest.mark.parametrize("name", ["regressor", "inertial_parameters", "forward_dynamics", "total_momentum"])
def test_formulas_equal_numbers(double: TestClient, name: str) -> None:
    answer = double.get(f"/v1/trees/cell/{name}", params={"bind": "defaults"})
    assert answer.status_code == 200, answer.text
    program = Program.from_bytes(answer.content)
    values = {s.name: 0.0 for s in program.symbols}
    for key, primes in (("q", ""), ("qd", "'"), ("qdd", "''")):
        values |= {f"{c}{primes}": STATES[key][0][a] for a, c in enumerate(("arm.q", "hand.q"))}
    found = interpret(program, values)
    one = {key: STATES[key][0] for key in ("q", "qd", "qdd")}
    quantity = "momentum" if name == "total_momentum" else name
    expected = double.post(URL, json={"quantities": [quantity], **one}).json()[quantity]
    pairs = (
        [(found[key], expected[key]) for key in expected] if isinstance(expected, dict) else [(found[name], expected)]
    )
    for x, y in pairs:
        np.testing.assert_allclose(x, y, atol=1e-12)


def test_formulas_of_the_regressor_name_their_columns(double: TestClient) -> None:
    document = double.get("/v1/trees/cell/regressor").json()
    assert document["columns"]["names"][:2] == ["arm.rod.m", "arm.rod.sx"]
    assert document["outputs"]["regressor"]["shape"] == [2, 20]


def test_parameters_for_every_state(double: TestClient) -> None:
    """A sweep equals one request for every set of parameters, for all quantities."""
    sets = {"arm.m": [1, 2, 3.5, 0.2], "hand.l": [1, 0.5, 0.25, 2], "g": [9.81, 0, 1.6, 3.7]}
    names = list(QUANTITIES)
    swept = ask(double, names, parameters=sets, along=ALONG)
    for i in range(4):
        one = {key: STATES[key][i] for key in ("q", "qd", "qdd")}
        along = {key: ALONG[key][i] for key in ("q", "qd", "qdd")} | {"inputs": ALONG["inputs"]}
        given = {"parameters": {name: x[i] for name, x in sets.items()}, "inputs": {"tau.arm.q": TAU[i]}}
        single = ask(double, names, **one, **given, along=along)
        for name in names:
            pairs = swept[name].items() if isinstance(swept[name], dict) else [(None, swept[name])]
            for key, some in pairs:
                expected = single[name] if key is None else single[name][key]
                np.testing.assert_allclose(some[i], expected, rtol=1e-12, atol=1e-12)


def test_the_size_of_an_answer_is_limited(double: TestClient) -> None:
    """A million states of the regressor would be 320 MB."""
    columns = {"arm.q": [0] * 250_000, "hand.q": [0] * 250_000}
    answer = double.post(URL, json={"quantities": ["regressor"], "q": columns, "qdd": {"arm.q": 0, "hand.q": 0}})
    assert (answer.status_code, answer.json()["code"]) == (422, "too-large"), answer.text[:200]


def test_no_states(double: TestClient) -> None:
    """From the interpreter, then from kernels."""
    names, none = list(QUANTITIES), {"arm.q": [], "hand.q": []}
    for _ in range(2):
        answer = double.post(URL, json={"quantities": names, "q": none, "qdd": none, "along": {"q": [1, 0]}})
        assert answer.status_code == 200, answer.text
        assert (answer.json()["count"], answer.json()["metric"]) == (0, [])
        assert double.post("/v1/trees/cell/kernels", json={"quantities": names}).status_code in (200, 201)


def test_no_wrong_formula_with_numbers_in_it_is_served(double: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outputs damaged in all ways by what puts the numbers in; a refusal says what is wrong."""
    address = "/v1/trees/cell/metric"
    source = Program.from_bytes(double.get(address).content)
    parameters = {symbol.name: {"value": None} for symbol in source.symbols if symbol.kind == "parameter"}
    first, *others = parameters
    text = ",".join([f"{first}:1/3", *(f"{name}:{first}^2 + 1.50" for name in others)])
    right = binding.bound(source, parameters, text)
    found = [wrong for _, _, wrong in damages(right, RNG)]
    for wrong in found:
        monkeypatch.setattr(binding, "bind", lambda *_, wrong=wrong: wrong)
        with pytest.raises(VerificationFailed, match="numbers in them: metric"):
            binding.bound(source, parameters, text)
    assert len(found) == 5
    answer = double.get(address, params={"bind": ",".join(f"{name}:1.5" for name in parameters)})
    assert answer.status_code == 500
    assert "metric" in answer.json()["detail"]


def test_formulas_keep_the_time_limit(filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """What takes longer is refused with what to do instead, and others are answered meanwhile."""
    let_go = threading.Event()

    def slow(*_: Any, **__: Any) -> Any:
        assert let_go.wait(60)
        raise ValueError("too late")

    limits = store.settings.limits.model_copy(update={"sync_seconds": 0.3})
    monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"limits": limits}))
    monkeypatch.setattr("service.jobs.kinds.export.text_of", slow)
    monkeypatch.setattr("service.jobs.kinds.export.made_text", slow)
    monkeypatch.setattr("service.operations.models.part_formulas", slow)
    try:
        answer = filled.get("/v1/substructures/pendulum/formulas/metric")
        assert (answer.status_code, answer.json()["code"]) == (503, "took-too-long")
        assert "component" in answer.json()["detail"]
        for quantity in ("metric", "first_integrals"):
            answer = filled.get(f"/v1/trees/cell/{quantity}")
            assert (answer.status_code, answer.json()["code"]) == (503, "took-too-long")
            assert "'export'" in answer.json()["detail"]
            assert filled.get("/v1/trees/cell").status_code == 200
    finally:
        let_go.set()


def test_options_of_other_quantities_are_refused(filled: TestClient) -> None:
    answer = filled.get("/v1/trees/cell/metric?inputs=tau.arm.q")
    assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "unknown-option")
    assert answer.json()["errors"][0]["pointer"] == "/query/inputs"
