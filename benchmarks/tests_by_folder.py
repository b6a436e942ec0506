"""Where the tests take their time: the seconds of a run by folder and by file, and the slowest tests.

    pytest --junitxml=FILE
    python -m benchmarks.tests_by_folder FILE [--files 30] [--tests 30]
    python -m benchmarks.tests_by_folder FILE --skipped

The seconds of a test are those of the clock on the wall with setup and teardown: beside other work more than the CPU's.
``--skipped``: the tests that were skipped, as arguments of pytest, instead.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as Tree  # of a file that the tests of this repository wrote


class Test(NamedTuple):
    """A test of the run; ``name`` is empty where a whole file was skipped."""

    file: str
    name: str
    seconds: float
    is_skipped: bool


def tests_of(file: Path) -> Iterator[Test]:
    """All tests of a run, from the file that ``pytest --junitxml`` writes."""
    for case in Tree.parse(file).iter("testcase"):  # noqa: S314 -- our own file
        module, name = case.get("classname", ""), case.get("name", "")
        if not module:
            module, name = name, ""
        path = module.replace(".", "/") + ".py"
        yield Test(path, name, float(case.get("time", 0)), case.find("skipped") is not None)


def table(title: str, rows: Iterable[tuple[str, float]], numbers: Mapping[str, int]) -> None:
    print(f"\n{title}")
    for name, seconds in rows:
        print(f"{seconds:9.2f} s {numbers[name]:6}  {name}")


def report(tests: Iterable[Test], most_files: int, most_tests: int) -> None:
    folders, files, single = Counter[str](), Counter[str](), Counter[str]()
    numbers: Counter[str] = Counter()
    for test in tests:
        names = str(Path(test.file).parent), test.file, f"{test.file}::{test.name}"
        for sums, name in zip((folders, files, single), names, strict=True):
            sums[name] += test.seconds
        numbers.update(names)
    table(f"by folder, in all {folders.total():.1f} s; number of tests", folders.most_common(), numbers)
    table("by file", files.most_common(most_files), numbers)
    table("the slowest tests", single.most_common(most_tests), numbers)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--files", type=int, default=30)
    parser.add_argument("--tests", type=int, default=30)
    parser.add_argument("--skipped", action="store_true")
    arguments = parser.parse_args()
    tests = tests_of(arguments.file)
    if arguments.skipped:
        print("\n".join(f"{t.file}::{t.name}" if t.name else t.file for t in tests if t.is_skipped))
    else:
        report(tests, arguments.files, arguments.tests)


if __name__ == "__main__":
    main()
