"""The pages of the jobs: progress without a script, and nothing of a job can be more than text."""

from __future__ import annotations

from fastapi.testclient import TestClient

from service.jobs.engines.engine import Outcome, Work
from service.jobs.kinds import failed
from service.messages.refusals import Refused
from service.store.store import Store

from .fake_engine import FakeEngine, eventually, export, finished, running, submitted
from .reading import read

EVIL = "<script>alert(1)</script>"


class Spiteful(FakeEngine):
    """The second item fails with a problem that would like to be executed."""

    def compute(self, work: Work) -> Outcome:
        return failed(Refused(422, "evil", EVIL)) if work.item["quantity"] == "forces" else super().compute(work)


def test_pages_of_jobs(filled: TestClient, store: Store) -> None:
    assert "None yet" in filled.get("/jobs").text
    with running(store, Spiteful(slots=1, is_open=False)) as engine:
        job = submitted(filled, export("cell", "metric", "forces"))
        eventually(filled, job, lambda view: view["state"] == "running")
        for path in ("/jobs", f"/jobs/{job}"):
            page = filled.get(path)
            assert '<meta http-equiv="refresh" content="2">' in page.text
            assert 'class="share"' in page.text
            assert "script-src" in page.headers["content-security-policy"]
            read(filled, path)
        engine.open()
        finished(filled, job)
    page = filled.get(f"/jobs/{job}").text
    assert "refresh" not in page
    assert "2 of 2" in page
    assert "1 failed" in page
    assert "alert(1)" in page
    assert EVIL not in page
    assert "refresh" not in filled.get("/jobs").text
    assert filled.get("/jobs/none").status_code == 404


def test_what_the_items_became(filled: TestClient, store: Store) -> None:
    """Links to what was stored, a picture of a motion, figures and files."""
    motion = {"tree": "cell", "request": {"q": [0.2], "span": [0, 1]}, "format": "svg"}
    tree = {"name": "made", "instances": [{"name": "a", "substructure": "pendulum"}]}
    with running(store, FakeEngine()):
        for kind, item, said, links in (
            ("simulate", motion, "is_right yes, status finished", ["files/result"]),
            ("assemble", tree, "dof 1, joints R", ["/trees/made@1"]),
        ):
            job = submitted(filled, {"kind": kind, "items": [item]})
            finished(filled, job)
            page = read(filled, f"/jobs/{job}")
            assert said in page.text
            for end in links:
                assert any(each.endswith(end) for each in page.links), page.links
