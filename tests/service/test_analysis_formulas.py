"""Formulas that follow from the equations of motion, as quantities of a tree."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.messages.negotiation import MEDIA_TYPES
from service.models.formulas import QUANTITIES
from service.models.grouping import QUANTITIES as GROUPED
from service.settings import Settings
from substructures.expr.interpret import interpret
from substructures.expr.program import Program

from .conftest import HAND, PENDULUM, TREE, make_client

PUCK: dict[str, Any] = {
    "name": "puck",
    "instances": [
        {
            "name": "p",
            "definition": {
                "name": "puck",
                "parameters": {"m": {"value": 2, "unit": "kg"}},
                "bodies": [
                    {"name": "arm", "parent": "base", "joint": {"type": "revolute", "coordinate": "phi"}},
                    {
                        "name": "puck",
                        "parent": "arm",
                        "joint": {"type": "prismatic", "coordinate": "r", "theta": "pi/2"},
                        "mass": "m",
                    },
                ],
            },
        }
    ],
}


@pytest.fixture(scope="module")
def double(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """The double pendulum cell@2, and a mass that slides freely on a turning arm."""
    path = tmp_path_factory.mktemp("formulas") / "store.db"
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        client = make_client(store)
        for place, body in (
            ("substructures", PENDULUM),
            ("trees", TREE),
            ("trees/cell/couplings", HAND),
            ("trees", PUCK),
        ):
            answer = client.post(f"/v1/{place}", json=body)
            assert answer.status_code == 201, answer.text
        yield client


@pytest.mark.parametrize("name", MEDIA_TYPES)
def test_every_quantity_in_every_format(double: TestClient, name: str) -> None:
    for quantity in QUANTITIES:
        tree = "puck" if quantity == "routhian" else "cell"
        answer = double.get(f"/v1/trees/{tree}/{quantity}", params={"format": name, "bind": "defaults"})
        assert answer.status_code == 200, (quantity, answer.text)
        assert answer.headers["content-type"].startswith(MEDIA_TYPES[name].partition(";")[0])
        if name == "json":
            Program.from_bytes(answer.content)


def test_first_integrals_say_why(double: TestClient) -> None:
    answer = double.get("/v1/trees/puck/first_integrals?bind=defaults")
    found = answer.json()
    assert found["cyclic"] == ["p.phi"]
    listed = {each["name"]: each for each in found["integrals"]}
    momenta = {"linear_momentum.x", "linear_momentum.y", "angular_momentum.z"}
    assert listed.keys() == {"energy", *momenta, "galilei.x", "galilei.y"}
    assert all(each["rule"] == "constant" and each["reason"] and each["unit"] for each in listed.values())
    source = Program.from_bytes(answer.content)
    state = {"t": 0.7, "p.phi": 0.3, "p.r": 3.0, "p.phi'": 0.5, "p.r'": 0.2}
    values = interpret(source, {s.name: state[s.name] for s in source.symbols})
    assert values["angular_momentum.z"] == pytest.approx(2 * 3.0**2 * 0.5)  # m r^2 phi'


def test_routh_reduces_the_order(double: TestClient) -> None:
    found = double.get("/v1/trees/puck/routhian", params={"cyclic": "p.phi"}).json()
    assert (found["coordinates"], found["cyclic"], found["momenta"]) == (["p.r"], ["p.phi"], ["p.p.phi"])
    text = double.get("/v1/trees/puck/routhian", params={"format": "text"}).text
    assert "amended_potential" in text


def test_state_space_with_outputs(double: TestClient) -> None:
    wanted = {"outputs": ["arm.q + hand.q", "arm.q'"], "inputs": "tau.arm.q"}
    found = double.get("/v1/trees/cell/state_space", params=wanted).json()
    assert found["inputs"] == ["tau.arm.q"]
    assert found["expressions"] == ["arm.q + hand.q", "arm.q'"]
    assert found["state"] == ["arm.q", "hand.q", "arm.q'", "hand.q'"]


def test_curvature_of_the_double_pendulum_depends_on_the_elbow_only(double: TestClient) -> None:
    source = Program.from_bytes(double.get("/v1/trees/cell/scalar_curvature?bind=defaults").content)
    assert {symbol.name for symbol in source.symbols} == {"hand.q"}
    assert math.isfinite(float(interpret(source, {"hand.q": 0.5})["scalar_curvature"]))


def test_base_parameters_are_combinations(double: TestClient) -> None:
    """A planar double pendulum: ZZ1, X1, Y1, ZZ2, X2, Y2."""
    found = double.get("/v1/trees/cell/base_parameters?bind=defaults").json()
    assert len(found["base"]) == 6
    assert set(found["combinations"]) == set(found["base"])
    more = double.get("/v1/trees/cell/base_parameters?drives=viscous,coulomb").json()
    assert len(more["base"]) == 6 + 4


@pytest.mark.parametrize("format_", ["text", "latex", "latex-document", "mathml"])
def test_what_people_read_is_in_the_textbook_form(double: TestClient, format_: str) -> None:
    for quantity in ("metric", "scalar_curvature"):
        url = f"/v1/trees/cell/{quantity}?format={format_}"
        found = [double.get(url + form).text for form in ("", "&form=readable", "&form=textbook", "&form=compact")]
        assert found[0] == found[1] == found[2] != found[3]


DECLARED = re.compile(r"# (\S+) is \w")
NAME = re.compile(r"(?<![\w.'])[A-Za-z_][\w.]*'*")


def undeclared(text: str) -> set[str]:
    """Names in the formulas of a text that are neither declared nor introduced."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    known = {m.group(1) for line in text.splitlines() if (m := DECLARED.match(line))}
    known |= {line.partition(" = ")[0] for line in lines} | {"cos", "sin", "sqrt", "sign", "pi"}
    assert lines
    return {name for line in lines for name in NAME.findall(line.partition(" = ")[2])} - known


@pytest.mark.parametrize("form", ["readable", "textbook", "compact", "expanded"])
@pytest.mark.parametrize("quantity", ["metric", "bias", "inverse_dynamics", "gravity", "generalised_momenta"])
def test_symbols_of_formulas_in_grouped_symbols_are_declared(double: TestClient, quantity: str, form: str) -> None:
    for group in ("true", "false"):
        text = double.get(f"/v1/trees/cell/{quantity}?group={group}&format=text&form={form}").text
        assert not undeclared(text)


def test_base_parameters_can_be_read(double: TestClient) -> None:
    """Each has a name, a formula, and what was grouped into it."""
    text = double.get("/v1/trees/cell/base_parameters?format=text").text
    assert "# arm.Jxx_rod stands for arm.rod.Jxx + arm.rod.Jyy + arm.l^2*hand.rod.m" in text
    assert "# hand.sx_rod is base parameter [kg m]" in text
    assert not undeclared(text)
    assert "grouping" not in text
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert {line.partition(" = ")[0] for line in lines} == {
        f"{instance}.{name}_rod" for instance in ("arm", "hand") for name in ("Jxx", "sx", "sy")
    }
    drives = double.get("/v1/trees/cell/base_parameters?format=text&drives=armature").text
    assert re.search(r"arm.Jxx_rod = .*arm.armature_q", drives)
    for format_ in ("latex", "latex-document", "mathml"):
        page = double.get(f"/v1/trees/cell/base_parameters?format={format_}").text
        assert r"\mathit{base}" not in page
        assert "stands for arm.rod.Jxx + arm.rod.Jyy" in page
    assert r"J_{\mathrm{arm},xx,\mathrm{rod}} &= " in double.get("/v1/trees/cell/base_parameters?format=latex").text


def test_units_of_base_parameters_are_those_of_their_names(client: TestClient) -> None:
    """First moments in kg m, moments of inertia in kg m^2: also of links with symbolic lengths."""
    file = Path(__file__).parent.parent / "interchange" / "cases" / "30-two-link-symbolic-lengths.json"
    client.post("/v1/trees", content=file.read_bytes(), headers={"Content-Type": "application/json"})
    text = client.get("/v1/trees/two-symbolic/base_parameters?format=text").text
    units = dict(re.findall(r"# (\w+) is base parameter \[(.*)\]", text))
    moments = {f"{name}_b{k}": unit for k in "12" for name, unit in (("sx", "kg m"), ("sy", "kg m"), ("Jxx", "kg m^2"))}
    assert units == moments


def test_formulas_in_grouped_symbols(double: TestClient) -> None:
    """ZZ2 = m2 (l2/2)^2 + ..., X2 = m2 l2/2, ZZ1 with the mass of the second rod at the end of the first one."""
    found = double.get("/v1/trees/cell/metric?group=true").json()
    told = {each["name"]: each for each in found["definitions"]}
    assert told.keys() == {"arm.Jxx_rod", "hand.Jxx_rod", "hand.sx_rod"}
    assert told["arm.Jxx_rod"]["combination"] == {"arm.rod.Jxx": "1", "arm.rod.Jyy": "1", "hand.rod.m": "arm.l^2"}
    assert (told["hand.sx_rod"]["unit"], told["hand.sx_rod"]["base"]) == ("kg m", "hand.rod.sx")
    assert {s["name"] for s in found["symbols"]} == {*told, "arm.l", "hand.q"}
    text = double.get("/v1/trees/cell/metric?group=true&format=text").text
    for name, each in told.items():
        assert f"\n{name} = {each['formula']}\n" in text
    bound = double.get("/v1/trees/cell/metric?group=true&bind=defaults,hand.sx_rod:3&format=text").text
    assert "metric[1, 2] = hand.Jxx_rod + 3*cos(hand.q)" in bound
    assert "hand.Jxx_rod = 0.55" in bound
    symbols = {name: each["formula"] for name, each in told.items()}
    assert symbols["hand.sx_rod"] in double.get("/v1/trees/cell/christoffel?group=true&format=text").text


def test_pages_of_formulas_may_have_their_style(double: TestClient) -> None:
    page = double.get("/v1/trees/cell/metric?format=mathml")
    assert "<style>" in page.text
    assert page.headers["content-security-policy"].startswith("default-src 'none'; style-src 'unsafe-inline'")
    assert "style-src" not in double.get("/v1/trees/cell/metric?format=text").headers["content-security-policy"]


def test_documents_say_whose_formulas_they_show(double: TestClient) -> None:
    assert "<h1>metric of cell, revision 2</h1>" in double.get("/v1/trees/cell/metric?format=mathml").text
    assert "<h1>U of pendulum, version 1</h1>" in double.get("/v1/substructures/pendulum/formulas/U?format=mathml").text
    document = double.get("/v1/trees/cell/metric?format=latex&document=true").text
    assert r"\section*{metric of cell, revision 2}" in document
    assert "<h1>mine</h1>" in double.get("/v1/trees/cell/metric?format=mathml&name=mine").text
    assert "model_metric" in double.get("/v1/trees/cell/metric?format=python").text


@pytest.mark.parametrize("name", ["json", "text", "latex", "latex-document", "mathml"])
def test_grouped_symbols_are_told_in_all_formats_for_people(double: TestClient, name: str) -> None:
    for quantity in GROUPED:
        answer = double.get(f"/v1/trees/cell/{quantity}", params={"format": name, "group": True})
        assert answer.status_code == 200, answer.text
        assert "definitions" in answer.text if name == "json" else "stands for" in answer.text


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("cell/potential_energy?group=true", 422, "not-grouped"),
        ("cell/metric?group=true&format=c", 422, "not-grouped"),
        ("cell/metric?group=true&joints=arm.q", 422, "unknown-option"),
        ("cell/nothing?group=true", 404, "unknown-quantity"),
        ("cell/metric?group=true&bind=arm.k:1", 422, "unknown-parameter"),
    ],
)
def test_what_has_no_grouped_symbols_is_refused(double: TestClient, path: str, status: int, code: str) -> None:
    answer = double.get(f"/v1/trees/{path}")
    assert (answer.status_code, answer.json()["errors"][0]["code"] if status == 422 else answer.json()["code"]) == (
        status,
        code,
    )


@pytest.mark.parametrize(
    ("path", "pointer"),
    [
        ("cell/routhian?cyclic=arm.q", "/query/cyclic/0"),
        ("cell/state_space?outputs=nobody", "/query/outputs/0"),
        ("cell/state_space?inputs=nobody", "/query/inputs/0"),
        ("cell/first_integrals?inputs=nobody", "/query/inputs"),
        ("cell/first_integrals?zero=nobody", "/query/zero"),
        ("cell/first_integrals?degree=3", "/query/degree"),
        ("cell/parameter_sensitivity?parameters=nobody", "/query/parameters/0"),
        ("cell/parameter_sensitivity?quantities=nothing", "/query/quantities/0"),
        ("cell/adjoint?running=nobody", "/query/running"),
        ("cell/adjoint?controls=nobody", "/query/controls/0"),
        ("cell/base_parameters?drives=rust", "/query/drives/0"),
        ("cell/curvature?drives=armature", "/query/drives"),
        ("cell/perturbation?format=pdf", "/query/format"),
        ("cell/perturbation?bind=nobody:1", "/query/bind"),
    ],
)
def test_wrong_options(double: TestClient, path: str, pointer: str) -> None:
    answer = double.get(f"/v1/trees/{path}")
    assert answer.status_code == 422, answer.text
    assert [error["pointer"] for error in answer.json()["errors"]] == [pointer]


def test_unknown_quantities_are_told_what_there_is(double: TestClient) -> None:
    answer = double.get("/v1/trees/cell/first_integral")
    assert answer.status_code == 404
    assert "first_integrals" in answer.json()["detail"]
    answer = double.get("/v1/trees/cell/xyz")
    assert answer.status_code == 404
    assert all(name in answer.json()["detail"] for name in ("metric", "first_integrals", "curvature"))


def test_they_are_cached_by_clients(double: TestClient) -> None:
    first = double.get("/v1/trees/cell@2/state_space")
    assert "immutable" in first.headers["cache-control"]
    same = double.get("/v1/trees/cell@2/state_space", headers={"If-None-Match": first.headers["etag"]})
    assert same.status_code == 304
    other = double.get("/v1/trees/cell@2/state_space?outputs=arm.q", headers={"If-None-Match": first.headers["etag"]})
    assert other.status_code == 200
