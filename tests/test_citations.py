"""Every section that a docstring, a comment or a page cites exists, and what the README links to."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDERS = ("substructures", "service", "migrations", "tests", "benchmarks", "docs")
HTTP = ROOT / "docs" / "reference" / "http"
CONTRACT = "HTTP contract"  # the pages of that folder together
NUMBER = r"\d+(?:\.\d+)?"
CITATION = re.compile(
    rf"(?P<page>[A-Za-z][\w-]*\.md|HTTP\s+contract)`?,\s+(?:#\s*)?sections?\s+(?:#\s*)?(?P<numbers>{NUMBER}(?:(?:,|\s+and|\s+to)\s+{NUMBER})*)"
)
HEADING = re.compile(r"#+ (\d+(?:\.\d+)?)\.? |(\d+)\. ")


def sections(text: str) -> set[str]:
    """Numbers of headings (``## 8. ...``, ``### 8.3 ...``), and of the points of a list in a section (8.3)."""
    found: set[str] = set()
    within = ""
    fenced = False
    for line in text.splitlines():
        fenced ^= line.startswith("```")
        heading = None if fenced else HEADING.match(line)
        if heading is None:
            continue
        number, point = heading.groups()
        if number:
            within = number
        found.add(number or f"{within}.{point}")
    return found


def pages() -> dict[str, set[str]]:
    """The sections of every page that is cited by its name, and of the HTTP contract."""
    found = [path for path in (ROOT / "docs").rglob("*.md") if path.parent.name in ("explanation", "reference")]
    contract = set[str]().union(*(sections(path.read_text()) for path in HTTP.glob("*.md")))
    return {path.name: sections(path.read_text()) for path in found} | {CONTRACT: contract}


def citations(text: str) -> Iterator[tuple[str, str]]:
    """(page, section) of every citation."""
    for match in CITATION.finditer(text):
        page = CONTRACT if match["page"].startswith("HTTP") else match["page"]
        yield from ((page, number) for number in re.findall(NUMBER, match["numbers"]))


def faults(text: str, known: Mapping[str, set[str]]) -> list[str]:
    """Citations of what there is not."""
    return [f"{page}, section {number}" for page, number in citations(text) if number not in known.get(page, set())]


def sources() -> list[Path]:
    """All files that may cite, this one left out."""
    found = [path for folder in FOLDERS for kind in ("*.py", "*.md") for path in (ROOT / folder).rglob(kind)]
    return sorted(path for path in found if path != Path(__file__).resolve())


def test_every_citation_leads_somewhere() -> None:
    known = pages()
    assert {"notation.md", CONTRACT, "format.md", "tables.md"} <= set(known)
    wrong = {str(path.relative_to(ROOT)): found for path in sources() if (found := faults(path.read_text(), known))}
    assert not wrong
    assert sum(1 for path in sources() for _ in citations(path.read_text())) > 30


def test_every_page_that_is_named_exists() -> None:
    """Also without a section; the pages outside of the folders are those of every repository."""
    known = {path.name for path in (*(ROOT / "docs").rglob("*.md"), *ROOT.glob("*.md"))}
    for path in sources():
        named = set(re.findall(r"(?<![\w{}*.-])[A-Za-z][\w-]*\.md\b", path.read_text()))
        assert named <= known, f"{path.relative_to(ROOT)}: {named - known}"


def test_the_science_names_no_page_of_the_service() -> None:
    above = {"tables.md", *(path.name for path in HTTP.glob("*.md"))}
    for path in sources():
        if path.is_relative_to(ROOT / "substructures"):
            assert not above & set(re.findall(r"[\w-]+\.md", path.read_text())), path


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("as in notation.md, section 5.", []),
        ("(notation.md, sections 3 and 7)", []),
        ("# notation.md,\n    # section 8.3", []),
        ("notation.md, section 77", ["notation.md, section 77"]),
        ("notation.md, sections 3 and 77", ["notation.md, section 77"]),
        ("(notation.md, section 8.99)", ["notation.md, section 8.99"]),
        ("mathematics.md, section 5", ["mathematics.md, section 5"]),
        ("the HTTP contract, section 99", ["HTTP contract, section 99"]),
        ("the HTTP\ncontract, section 4", []),
    ],
)
def test_a_planted_citation_is_found(text: str, expected: list[str]) -> None:
    assert faults(text, pages()) == expected


def test_points_of_lists_and_headings_are_sections() -> None:
    text = "# P\n## 1. A\n1. x\n2. y\n## 2. B\n```\n## 9. code\n```\n### 2.1 C\n"
    assert sections(text) == {"1", "1.1", "1.2", "2", "2.1"}


def test_the_readme_links_to_what_is_there() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", (ROOT / "README.md").read_text())
    assert {"docs/explanation/notation.md", "docs/reference/http/index.md"} <= set(links)
    assert all((ROOT / link).exists() for link in links), links


def test_the_pages_say_what_people_look_for() -> None:
    """The equation of motion, Gamma and Q at the top of the notation."""
    top = (ROOT / "docs" / "explanation" / "notation.md").read_text().split("\n## 1.")[0]
    assert "g_ab q''^b + Gamma_abc q'^b q'^c = Q_a" in top
    assert "Gamma_abc = 1/2 (d_b g_ac + d_c g_ab - d_a g_bc)" in top
    assert re.search(r"Q_a = .*gravity.*springs and dampers.*actuator", top, re.DOTALL)
