"""``substructures demo``: the main job over real HTTP, on a temporary database, checked against published numbers.

Published: P. Corke, Robotics Toolbox for Python, ``tests/test_DHRobot.py``; Puma 560 with armature, 4 decimals.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Sequence
from contextlib import nullcontext, redirect_stdout
from pathlib import Path
from time import perf_counter
from typing import Any

from service.cli.options import Json
from service.cli.output import print_json, shipped
from service.server import background
from service.settings import Settings
from substructures.client import Client

ROBOT, GRIPPER = "puma560", "parallel-gripper"
STATE = (0.0, math.pi / 4, math.pi, 0.0, math.pi / 4, 0.0)
PUBLISHED_METRIC = (
    (3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0),
    (-0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0),
    (0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0),
    (-0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0),
    (0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0),
    (0.0, 0.0, 0.0, 0.0, 0.0, 0.1941),
)
PUBLISHED_GRAVITY = (0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0)  # +dV/dq
ROUNDING = 0.5e-4 + 1e-9
EXCERPT, WIDTH = 10, 112


def run(as_json: bool = False) -> int:
    """Do the main job and print what was done; 0 when all numbers agree, 1 when not. What was compared is printed as
    JSON if it is wanted, and the rest then goes to the stream of errors.
    """
    with redirect_stdout(sys.stderr) if as_json else nullcontext():
        checks = _job()
    agrees = all(check["agrees"] for check in checks)
    if as_json:
        print_json({"agrees": agrees, "checks": checks})
    return 0 if agrees else 1


def _job() -> list[dict[str, Any]]:
    """What was compared, each with the largest difference and whether it is within the rounding."""
    with tempfile.TemporaryDirectory(prefix="substructures-demo-") as folder:
        settings = Settings(database=f"sqlite:///{Path(folder) / 'demo.db'}")
        start = perf_counter()
        with shipped() as told, background(settings, told) as address, Client(address) as client:
            print(f"Server with the shipped catalogue on {address} ({_ms(start)}, temporary database).\n")
            _show_stored(client)
            checks = [_check_robot(client)]
            _couple(client)
            checks.append(_check_coupled(client))
    agrees = all(check["agrees"] for check in checks)
    print("\nAll numbers agree with the published ones." if agrees else "\nThe numbers DISAGREE.")
    return checks


def _ms(start: float) -> str:
    return f"{1000 * (perf_counter() - start):.0f} ms"


def _show_stored(client: Client) -> None:
    print("Stored substructures, formulas derived and verified:")
    for name in (ROBOT, GRIPPER):
        version = client.substructure(name)
        counts = version["operations"]
        print(
            f"  {name}@{version['version']}: {version['title']}, joints {version['joints']}, {version['digest'][:15]}"
        )
        print(
            f"    {counts['total']} operations in all; metric {counts['metric']}, christoffel {counts['christoffel']}"
        )


def _check_robot(client: Client) -> dict[str, Any]:
    start = perf_counter()
    arm = {"name": "arm", "substructure": ROBOT, "at": "world"}
    client.create_tree({"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [arm]})
    print(f"\nPOST /v1/trees: the arm alone, cell@1 ({_ms(start)}). At the published state")
    print("q = (0, pi/4, pi, 0, pi/4, 0) its metric is (kg m^2), published 4 decimals beside it:")
    result = client.evaluate("cell@1", quantities=["metric", "gravity"], q=STATE)
    for row, published in zip(result["metric"], PUBLISHED_METRIC, strict=True):
        print("   ", _numbers(row), "  |", _numbers(published))
    gravity = [-force for force in result["gravity"]]
    print("  gravity (N m), +dV/dq:")
    print("   ", _numbers(gravity), "  |", _numbers(PUBLISHED_GRAVITY))
    return compare(
        "the arm alone, largest difference", [*result["metric"], gravity], [*PUBLISHED_METRIC, PUBLISHED_GRAVITY]
    )


def _couple(client: Client) -> None:
    start = perf_counter()
    tree = client.couple("cell", {"name": "hand", "substructure": GRIPPER, "at": "arm.flange"})
    print(f"\nPOST /v1/trees/cell/couplings: the gripper onto arm.flange, cell@{tree['revision']} ({_ms(start)}).")
    print(f"  coordinates {', '.join(tree['coordinates'])}")
    start = perf_counter()
    text = client.formula("cell", "metric")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    elements = [line for line in lines if line.startswith("metric")]
    print(f"\nGET /v1/trees/cell/metric?format=text: {len(elements)} elements, {len(lines) - len(elements)} shared")
    print(f"subexpressions ({_ms(start)}), among them:")
    for line in [*lines[:EXCERPT], "...", *elements[:EXCERPT], "..."]:
        print("    " + (line if len(line) <= WIDTH else line[: WIDTH - 3] + "..."))


def _check_coupled(client: Client) -> dict[str, Any]:
    """With a massless gripper the coupled formulas have to give the published numbers of the arm."""
    parameters = client.substructure(GRIPPER)["parameters"]
    massless = {f"hand.{name}": 0.0 for name, each in parameters.items() if each["unit"] in ("kg", "kg*m^2")}
    start = perf_counter()
    real = client.evaluate("cell", quantities=["metric"], q=[*STATE, 0.01, 0.02])["metric"]
    light = client.evaluate("cell", quantities=["metric"], q=[*STATE, 0.01, 0.02], parameters=massless)["metric"]
    print(f"\nPOST /v1/trees/cell/evaluations, twice ({_ms(start)}): first row of the metric with the gripper,")
    print("   ", _numbers(real[0]))
    block = [row[: len(STATE)] for row in light[: len(STATE)]]
    return compare("with a massless gripper, largest difference to the published arm", block, PUBLISHED_METRIC)


def _numbers(row: Sequence[float]) -> str:
    return " ".join(f"{round(value, 4) + 0.0:8.4f}" for value in row)


def compare(title: str, found: Sequence[Sequence[Any]], published: Sequence[Sequence[float]]) -> dict[str, Any]:
    """Print the largest difference, and answer it with whether it is within the rounding of the published figures."""
    pairs = ((x, y) for a, b in zip(found, published, strict=True) for x, y in zip(a, b, strict=True))
    worst = max(abs(x - y) for x, y in pairs)
    agrees = worst <= ROUNDING
    print(f"  {title}: {worst:.1e} ({'agrees: rounding of the published figures' if agrees else 'DISAGREES'})")
    return {"what": title, "difference": worst, "agrees": agrees}


def demo(json: Json = False) -> int:
    """Couple a gripper onto a Puma 560 over HTTP and compare with published numbers."""
    return run(json)


COMMANDS = {"demo": demo}
