"""Results as diagrams: coordinates over time with the drift of first integrals, eigenvalues and steady motions over a
parameter, Bode diagrams of frequency responses, Poincare sections.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.orbits.sections import PoincareSection
from substructures.analysis.plot import Line, Panel, plot
from substructures.analysis.stability.frequency_response import FrequencyResponse
from substructures.analysis.stability.root_locus import RootLocus
from substructures.analysis.stability.steady_result import BallSteadyMotion, SteadyMotion, SteadyMotions
from substructures.analysis.verdict import Check
from substructures.array import Array

TIME = "t in s"
#: spread of what is the same at all crossings of a section [rad, m, per s]
HELD = 1e-9


def draw(found: Trajectory | RootLocus | SteadyMotions | FrequencyResponse, joints: str) -> str:
    """A motion, section, root locus, frequency response or steady motions as SVG. Raises ValueError for others."""
    if isinstance(found, FrequencyResponse):
        return draw_frequency_response(found)
    if isinstance(found, RootLocus):
        return draw_root_locus(found)
    if isinstance(found, SteadyMotions):
        return draw_steady_motions(found, joints)
    if isinstance(found, PoincareSection):
        return draw_section(found, joints)
    if not isinstance(found, Trajectory):
        raise ValueError(f"there is no picture of a {type(found).__name__}")
    return draw_trajectory(found, joints)


def draw_trajectory(motion: Trajectory, joints: str) -> str:
    """SVG: angles, distances, and how far quantities that are constant moved from their first values.

    ``joints``: R or P for every coordinate.
    """
    events = tuple((event.name, event.t) for event in motion.events)
    panels = [
        Panel(title, TIME, unit, lines, events)
        for kind, title, unit in (("R", "angles", "rad"), ("P", "distances", "m"))
        if (lines := tuple(_coordinates(motion, joints, kind)))
    ]
    drifts = tuple(_drifts(motion))
    if drifts:
        panels.append(Panel("drift over scale of what must be constant", TIME, "1", drifts, events))
    return plot(_title(motion), panels)


def draw_section(section: PoincareSection, joints: str) -> str:
    """SVG: the crossings in the plane of each coordinate and its velocity, of rates of ball joints over the time."""
    panels, columns = [], section.positions or section.coordinates
    for a, name in enumerate(section.coordinates):
        unit, across = "rad" if joints[a] == "R" else "m", section.t
        told = "t in s"
        if name in columns:
            across, told = section.q[:, columns.index(name)], f"{name} in {unit}"
        dots = Line(f"{len(section.t)} crossings", _held(across), _held(section.qd[:, a]), dots=True)
        panels.append(Panel(name, told, f"{name}' in {unit}/s", (dots,)))
    return plot(f"section, {_title(section)}", panels)


def _held(x: Array) -> Array:
    """What a section holds, up to where it is found, as one number: an axis of rounding says nothing."""
    level = float(np.median(x)) if len(x) else 0.0
    is_held = np.abs(x - level).max(initial=0) <= HELD * (1 + abs(level))
    return np.full(len(x), round(level, 9)) if is_held else x


def _title(motion: Trajectory) -> str:
    made = [check for check in motion.checks if check.made]
    wrong = [check for check in made if not check.holds]
    if wrong:
        first = min(wrong, key=lambda check: check.time or 0.0)
        return f"{motion.status}, WRONG: {first.name} violated at t = {first.time:.6g} s"
    if motion.is_right is None:
        return f"{motion.status}, not known to be right"
    return f"{motion.status}: all {len(made)} checks hold"


def _coordinates(motion: Trajectory, joints: str, kind: str) -> Iterator[Line]:
    columns = motion.positions or motion.coordinates
    for a, name in enumerate(motion.coordinates):
        if joints[a] == kind and name in columns:
            yield Line(name, motion.t, motion.q[:, columns.index(name)])


def _drifts(motion: Trajectory) -> Iterator[Line]:
    for check in motion.checks:
        values = _judged(motion, check)
        if values is not None and len(values):
            # (H(t) - H(0)) / scale
            yield Line(check.name, motion.t, (values - values[0]) / (check.scale or 1.0))


def _judged(motion: Trajectory, check: Check) -> Array | None:
    """The series that a check is about."""
    series = motion.series
    if check.name == "energy-balance" and {"energy", "work"} <= series.keys():
        # H - W
        return np.asarray(series["energy"] - series["work"])
    values = series.get(check.name) if check.rule == "constant" else None
    return values if values is not None and values.ndim == 1 else None


def draw_root_locus(locus: RootLocus) -> str:
    """SVG: the branches in the complex plane, and the real parts over the parameter; below zero is stable."""
    # s = real + i imaginary of exp(s t)
    real, imaginary = locus.eigenvalues.real, locus.eigenvalues.imag
    branches = range(real.shape[1])
    plane = tuple(Line(f"branch {k + 1}", real[:, k], imaginary[:, k], dots=True) for k in branches)
    parts = tuple(Line(f"branch {k + 1}", locus.values, real[:, k]) for k in branches)
    zero = (("", 0.0),) if real.size and real.min() <= 0 <= real.max() else ()
    panels = [
        Panel("eigenvalues", "real part in 1/s", "imaginary part in 1/s", plane, zero),
        Panel("real parts over the parameter", "parameter", "1/s", parts),
    ]
    return plot(f"root locus, {locus.status}: {len(locus.values)} values", panels)


def draw_steady_motions(steady: SteadyMotions, joints: str) -> str:
    """SVG: each number of q that keeps still over what varies, or over the first rate (with ball joints without such
    rates over the precession), by verdict; with bifurcations.
    """
    found = steady.found
    first = found[0] if found else None
    names = first.positions if isinstance(first, BallSteadyMotion) else first.coordinates if first else ()
    units = {
        name: "rad" if joint == "R" else "m"
        for name, joint in zip(first.coordinates if first else (), joints, strict=False)
    }
    q = np.array([motion.q for motion in found]).reshape(len(found), len(names))
    over = np.array([_over(motion) for motion in found], dtype=np.float64)
    verdicts = np.array([motion.verdict for motion in found], dtype=object)
    marks = tuple((one.kind, one.at.value) for one in steady.bifurcations if one.at.value is not None)
    label = steady.vary or (f"rate of {steady.moving[0]}" if steady.moving else "precession")
    panels = []
    for a, name in enumerate(names):
        if name not in steady.moving:
            by_verdict = {verdict: verdicts == verdict for verdict in sorted(set(verdicts))}
            lines = tuple(Line(verdict, over[these], q[these, a], dots=True) for verdict, these in by_verdict.items())
            panels.append(Panel(name, label, units.get(name, "m, 1"), lines, marks))
    return plot(f"steady motions: {len(found)} found, {len(marks)} bifurcations", panels)


def _over(motion: SteadyMotion) -> float:
    """What a steady motion is drawn over."""
    if motion.value is not None:
        return motion.value
    if len(motion.rates):
        return float(motion.rates[0])
    return motion.precession if isinstance(motion, BallSteadyMotion) else 0.0


def draw_frequency_response(response: FrequencyResponse) -> str:
    """SVG, a Bode diagram: magnitude and phase of every output to every input over the frequency."""
    pairs = [(k, m) for k in range(len(response.outputs)) for m in range(len(response.inputs))]
    # lg w, 20 lg |G|, arg G; nothing is seen of a frequency 0 and of a response 0
    with np.errstate(divide="ignore", invalid="ignore"):
        over, size = np.log10(response.frequencies), 20 * np.log10(response.magnitude)
    seen = np.isfinite(over)[:, None, None] & np.isfinite(size)
    panels = []
    for title, unit, values in (("magnitude", "dB", size), ("phase", "degrees", np.degrees(response.phase))):
        lines = (
            Line(f"{response.outputs[k]} to {response.inputs[m]}", over[seen[:, k, m]], values[seen[:, k, m], k, m])
            for k, m in pairs
        )
        panels.append(Panel(title, "lg of the frequency in rad/s", unit, tuple(lines)))
    return plot(f"frequency response, {response.status}: {len(response.frequencies)} frequencies", panels)
