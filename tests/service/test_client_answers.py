"""What the client answers with: dictionaries with attributes, shown in notebooks, as tables, and jobs as objects."""

from __future__ import annotations

import copy
import io
import json
import pickle
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from service.server import background
from service.settings import Settings
from substructures import Definition, TreeSpec, couple, derive, render
from substructures.client import Answer, Client, Evaluation, Formula, Job, Picture, ProblemError, Tree, Version
from substructures.client.progress import Bar
from substructures.display import mathematics
from substructures.errors import InvalidDocument
from substructures.pictures.tree import picture

from .conftest import HAND, PENDULUM, SLIDER, TREE


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A client of a server that knows pendulum, slider and the tree cell."""
    path = tmp_path_factory.mktemp("answers") / "x.db"
    with background(Settings(database=f"sqlite:///{path}", catalogue=False)) as address, Client(address) as found:
        found.submit(PENDULUM)
        found.submit(SLIDER)
        found.create_tree(TREE)
        yield found


def needs(package: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(find_spec(package) is None, reason=f"frames of {package} need it installed")


def test_members_are_attributes_and_items(client: Client) -> None:
    version = client.substructure("pendulum")
    assert isinstance(version, Version)
    assert version.ref == "pendulum@1"
    assert version.coordinates == version["coordinates"] == ["q"]
    assert "coordinates" in dir(version)
    with pytest.raises(AttributeError, match="'nothing' is not in this answer"):
        version.nothing  # noqa: B018 -- it is asked for


def test_newer_members_are_kept_and_copies_are_plain(client: Client) -> None:
    told = dict(client.substructure("pendulum"))
    newer = client.version_of({**told, "hue": "blue"})
    assert newer.hue == "blue"
    for made in (copy.copy(newer), copy.deepcopy(newer), pickle.loads(pickle.dumps(newer))):  # noqa: S301 -- our own
        assert type(made) is dict
        assert made == newer
    assert json.loads(json.dumps(newer))["hue"] == "blue"


def test_answers_stand_for_their_references(client: Client) -> None:
    first = client.tree("cell@1")
    second = client.couple(first, HAND)
    assert isinstance(second, Tree)
    assert (first.ref, second.ref) == ("cell@1", "cell@2")
    assert [tree.revision for tree in client.revisions("cell")] == [2, 1]
    assert client.tree_difference(first, second).words
    assert client.uncouple(second, "hand").dof == 1
    assert client.compare(client.substructure("pendulum"), "pendulum").equal


def test_pages(client: Client) -> None:
    page = client.search(facets=True, page_size=1, sort="name")
    assert [version.name for version in page] == ["pendulum"]
    assert page.told.facets["tags"]["planar"] == 2
    following = client.search(facets=True, page_size=1, sort="name", page_token=page.next_page_token)
    assert following[0].name == "slider"
    assert [version.name for version in client.substructures(tag=["planar", "textbook"])] == ["pendulum"]


def test_aliases_are_created_and_moved(client: Client) -> None:
    client.submit({**PENDULUM, "name": "moved"})
    client.submit({**PENDULUM, "name": "moved", "title": "Another"})
    assert client.set_alias("moved", "stable", 1).version == 1
    assert client.set_alias("moved", "stable", 2).version == 2
    assert [alias.alias for alias in client.aliases("moved")] == ["stable"]
    with pytest.raises(ProblemError, match="404"):
        client.set_alias("nothing", "stable", 1)


def test_definitions_come_back_exact(client: Client) -> None:
    definition = client.definition("slider")
    assert client.submit(definition) == (client.substructure("slider"), False)


def test_formulas_are_texts_shown_as_mathematics(client: Client) -> None:
    formula = client.formula("cell@1", "metric")
    assert isinstance(formula, str)
    assert "metric[1, 1] = " in formula
    shown = formula._repr_mimebundle_()
    assert shown["text/plain"] == formula
    latex = client.formula("cell@1", "metric", "latex")
    assert shown["text/latex"] == latex._repr_latex_()
    assert shown["text/latex"].startswith("$$\n\\begin{aligned}")
    assert "%" not in shown["text/latex"]
    assert client.formula("cell@1", "metric", "c")._repr_latex_() is None
    assert "text/latex" in client.part_formula("pendulum", "U", body="rod")._repr_mimebundle_()


def test_equations_for_constraints_are_formulas(client: Client) -> None:
    client.create_tree({**TREE, "name": "pair", "instances": [*TREE["instances"], HAND]})
    given = {"constraints": [{"type": "linear", "name": "gear", "expression": "arm.q' - 2*hand.q'"}]}
    assert "text/latex" in client.velocity_equations("pair", given)._repr_mimebundle_()


class _Printer:
    """As much of IPython's as is used: without what is asked of it here it shows texts as texts are written."""

    def __init__(self) -> None:
        self.shown = ""

    def text(self, text: str) -> None:
        self.shown += text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (Formula("# a model\nx^2"), "# a model\nx^2"),
        (Picture("<svg/>"), "a picture (SVG, 6 characters)"),
    ],
)
def test_terminals_show_lines_and_no_quotes(text: Formula | Picture, words: str) -> None:
    printer = _Printer()
    text._repr_pretty_(printer, False)
    assert printer.shown == words


def test_mathematics_of_a_formula_is_asked_for_once() -> None:
    asked: list[str] = []

    def latex() -> str:
        asked.append("latex")
        return "% a comment\nx^{2}\n\n"

    formula = Formula("x^2", latex)
    assert [formula._repr_latex_() for _ in range(2)] == ["$$\nx^{2}\n$$"] * 2
    assert asked == ["latex"]
    assert copy.copy(formula) == "x^2"
    assert mathematics("x") == "$$\nx\n$$"


def test_parts_and_trees_are_pictures(client: Client) -> None:
    for answer in (client.substructure("pendulum"), client.tree("cell@1")):
        shown = answer._repr_mimebundle_()
        assert shown["image/svg+xml"].startswith("<svg")
        assert shown["text/plain"] == repr(answer)
        assert isinstance(answer.picture([0.1]), Picture)


def test_without_a_server_there_is_the_text(client: Client) -> None:
    with Client(client.address, retries=0) as other:
        version, formula = other.substructure("pendulum"), other.formula("cell@1", "metric")
    assert version._repr_mimebundle_() == {"text/plain": repr(version)}
    assert formula._repr_mimebundle_() == {"text/plain": str(formula)}


def test_the_library_shows_the_same_without_a_server() -> None:
    part = derive(Definition.read(PENDULUM))
    spec = TreeSpec.read(TREE)
    model = couple(spec, {"arm": part})
    text = render(model.program.select(["metric"]), "text")
    assert "text/latex" in text._repr_mimebundle_()
    assert picture(spec, {"arm": part}, model)._repr_svg_().startswith("<svg")


@needs("pandas")
def test_motions_are_frames(client: Client) -> None:
    motion = client.simulate("cell@1", q=np.array([0.3]), span=[0, np.float64(0.1)], step=0.05, reactions=True)
    frame = motion.to_pandas()
    assert list(frame.columns[:4]) == ["t", "q.arm.q", "qd.arm.q", "energy"]
    assert "reaction_force.arm.q.x" in frame.columns
    assert frame["q.arm.q"].to_numpy() == pytest.approx(motion.q[:, 0])
    assert "is_right=True" in repr(motion)


@needs("polars")
def test_evaluations_are_frames(client: Client) -> None:
    q = np.array([[0.1], [0.2]])
    frame = client.evaluate("cell@1", quantities=["metric", "forces", "kinematics"], q=q, qd=[0.5], t=1).to_polars()
    assert frame.columns[:5] == ["t", "q.arm.q", "qd.arm.q", "metric.arm.q.arm.q", "forces.arm.q"]
    assert frame["qd.arm.q"].to_list() == [0.5, 0.5]
    assert "kinematics.position.arm.tip.x" in frame.columns


def test_columns_of_every_quantity_have_names(client: Client) -> None:
    """Also of those whose rows and columns are loads, joints and parameters."""
    wanted = ["regressor", "inertial_parameters", "reactions", "powers", "condition"]
    for q in ([0.1], np.array([[0.1], [0.2]])):
        found = client.evaluate("cell@1", quantities=wanted, q=q, qdd=[0])
        assert repr(found).startswith(f"Evaluation: {', '.join(name for name in found if name in wanted)} for ")
        columns = found.columns()
        expected = {"regressor.arm.q.arm.rod.m", "inertial_parameters.arm.rod.Jzz", "reactions.moment.arm.q.x"}
        assert {"powers.gravity", "powers.tau.arm.q", "condition", *expected} <= columns.keys()
        assert not [name for name in columns if name.rpartition(".")[2].isdigit()]
    motion = client.simulate("cell@1", q=[0.3], span=[0, 0.1], step=0.05, powers=True)
    assert motion.columns()["powers.gravity"] == pytest.approx(np.asarray(motion.series["powers"])[:, 0])


@pytest.mark.parametrize(
    ("q", "known"),
    [
        *(([0.1], True), ([[0.1]], True), (0.1, True), ({"arm.q": 0.1}, True), ({"arm.q": [0.1]}, True)),
        *(({"value": 30, "unit": "deg"}, False), ({"arm.q": {"value": [30], "unit": "deg"}}, False)),
    ],
)
def test_one_state_is_one_row(client: Client, q: Any, known: bool) -> None:
    columns = client.evaluate("cell@1", quantities=["metric", "kinematics"], q=q).columns()
    assert ("q.arm.q" in columns) == known
    assert columns["metric.arm.q.arm.q"] == pytest.approx([2.2])
    assert all(values.shape == (1,) for values in columns.values())
    assert columns["kinematics.rotation.arm.tip.z.z"].shape == (1,)


def test_axes_of_three_coordinates_are_not_those_of_space() -> None:
    told = {
        "coordinates": ["a", "b", "c"],
        "count": 2,
        "momentum": {"linear": np.zeros((2, 3))},
        "metric": np.ones((2, 6)),
    }
    columns = Evaluation(told, {"q": np.zeros((2, 3))}).columns()
    assert {"momentum.linear.x", "metric.5", "q.c"} <= columns.keys()


@needs("pandas")
def test_columns_of_frames_are_given_as_arrays(client: Client) -> None:
    frame = client.evaluate("cell@1", quantities=["metric"], q=[[0.1], [0.2]]).to_pandas()
    with pytest.raises(InvalidDocument, match=r"/q/arm.q: Series is not plain data: .* NumPy's arrays"):
        client.evaluate("cell@1", quantities=["metric"], q={"arm.q": frame["q.arm.q"]})
    again = client.evaluate("cell@1", quantities=["metric"], q={"arm.q": frame["q.arm.q"].to_numpy()})
    assert again.to_pandas().equals(frame)


def test_without_pandas_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr("substructures.client.frames.import_module", missing)
    with pytest.raises(ImportError, match="pip install polars"):
        Evaluation({"coordinates": [], "count": 0}).to_polars()


def test_arrays_in_arrays_out(client: Client) -> None:
    found = client.analyse("cell@1", "linearisations", q=np.zeros(1))
    assert isinstance(found.M, np.ndarray)
    assert isinstance(client.analyse("cell@1", "linearisations", q=[0]).M, list)
    numbers = client.evaluate("cell@1", quantities=["metric"], q=[np.float32(0.5)], parameters={"g": np.int64(9)})
    assert numbers.metric == [[2.2]]


def test_jobs_are_objects(client: Client, capsys: pytest.CaptureFixture[str]) -> None:
    grid = {"arm.q": np.linspace(0, 1, 5), "arm.q'": [0, 1]}
    items = [{"tree": "cell@1", "request": {"quantities": ["metric"]}, "grid": grid}]
    job = client.submit_job({"kind": "evaluate", "items": items})
    assert isinstance(job, Job)
    assert job.wait(progress=True) is job
    assert (job.state, job.is_ended) == ("succeeded", True)
    assert capsys.readouterr().err.strip().endswith("succeeded  1 of 1")
    (found,) = job.results()
    assert found.columns()["qd.arm.q"].tolist() == [0, 1] * 5
    assert [item.state for item in job.each()] == ["succeeded"]
    assert json.loads(json.dumps(job)) == client.job(job)
    assert {event for _, event, _ in job.events()} >= {"state"}
    with pytest.raises(ProblemError, match="409"):
        job.retry()
    job.remove()
    with pytest.raises(ProblemError, match="404"):
        job.refresh()


def test_results_of_other_kinds(client: Client, tmp_path: Path) -> None:
    request = {"q": [0.3], "span": [0, 0.1]}
    items = [{"tree": "cell@1", "request": request, "format": form} for form in ("npz", "json", "csv")]
    job = client.submit_job({"kind": "simulate", "items": items}).wait()
    motion, answer, table = job.results()
    assert motion.q[-1, 0] == pytest.approx(answer.q[-1][0])
    assert table.startswith(b"t,arm.q")
    assert job.archive(tmp_path / "x.zip") == (tmp_path / "x.zip").stat().st_size
    derived = client.submit_job({"kind": "verify", "items": [{"substructure": "pendulum"}]}).wait()
    assert [type(each) for each in derived.results()] == [Answer]


class _Terminal:
    """A stream that a person watches."""

    def __init__(self) -> None:
        self.text = ""

    def isatty(self) -> bool:
        return True

    def write(self, text: str) -> int:
        self.text += text
        return len(text)

    def flush(self) -> None:
        """Nothing."""


def test_the_bar_is_written_over() -> None:
    stream = _Terminal()
    bar = Bar(stream)  # type: ignore[arg-type] # as much of a stream as it needs
    progress = {"done": 1, "failed": 1, "total": 4, "fraction": 0.25, "eta_seconds": 12.0}
    bar.show({"state": "running", "progress": progress})
    bar.lost(3, "refused")
    bar.end({"state": "succeeded", "progress": {**progress, "done": 4, "fraction": 1.0, "eta_seconds": None}})
    first, lost, last = stream.text.split("\r")[1:]
    assert first == "[#######.......................]  running  1 of 4, 1 failed  12 s left"
    assert lost.rstrip() == "the server cannot be reached for 3 s: refused"
    assert len(lost) == len(first)
    assert last.rstrip() == f"[{'#' * 30}]  succeeded  4 of 4, 1 failed"


def test_the_bar_where_nobody_watches_is_a_line() -> None:
    stream = io.StringIO()
    bar = Bar(stream)
    progress = {"done": 1, "failed": 0, "total": 4, "fraction": 0.25, "eta_seconds": 12.0}
    bar.show({"state": "running", "progress": progress})
    bar.end({"state": "succeeded", "progress": {**progress, "done": 4, "fraction": 1.0, "eta_seconds": None}})
    assert stream.getvalue() == f"[{'#' * 30}]  succeeded  4 of 4\n"


def test_robot_files(client: Client, tmp_path: Path) -> None:
    (tmp_path / "rod.urdf").write_text('<robot name="rod"><link name="ground"/></robot>')
    found = client.import_file(tmp_path / "rod.urdf", store=True)
    assert "rod.urdf" in found.definition["source"]
    assert found.stored["name"] == "rod"


def test_what_became_a_job_is_waited_for(tmp_path: Path) -> None:
    """Everything that the service can defer is deferred."""
    settings = Settings(database=f"sqlite:///{tmp_path / 'x.db'}", catalogue=False, workers=1)
    with background(settings) as address, Client(address) as client:
        client._http.headers["Prefer"] = "respond-async"
        version, _ = client.submit(PENDULUM)
        assert version.ref == "pendulum@1"
        assert client.create_tree(TREE).ref == "cell@1"
        assert client.publish("cell", name="piece").name == "piece"
        robot = b'<robot name="rod"><link name="ground"/></robot>'
        assert client.import_file(robot, store=True).stored["name"] == "rod"
        assert client.export_files("trees", "cell", "c")[:2] == b"PK"
        client.couple("cell", HAND)
        gear = {"type": "linear", "name": "gear", "expression": "arm.q' - 2*hand.q'"}
        assert "rates[1] = 2*hand.q'" in client.velocity_equations("cell", {"constraints": [gear]})
        found = client.evaluate("cell@1", quantities=["metric"], q=[[0.1], [0.2]])
        assert found.columns()["q.arm.q"].tolist() == [0.1, 0.2]
        assert found.metric.shape == (2, 1, 1)
