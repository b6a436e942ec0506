"""Conclusions about rest: where a model rests, whether that is stable and why, and how it vibrates there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from substructures.analysis.report.statements import Dependence, Figure, Names, Statement, in_short, reason_of
from substructures.analysis.stability.equilibria import Equilibria, Equilibrium, equilibria
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.analysis.stability.vibrations import Mode
from substructures.errors import InvalidInput, MissingValue, TooLarge, VerificationFailed, listed
from substructures.quantities.numbers.limits import joint_limits
from substructures.tree.model import Model

#: coordinates and operations of a model up to which positions of rest are looked for, random starts, places told
MOST_COORDINATES, MOST_OPERATIONS, STARTS, TOLD = 12, 4000, 16, 6
#: the order in which places are told
VERDICTS = ("asymptotically stable", "stable", "undecided", "unstable", "failed")


@dataclass(frozen=True)
class Rest:
    """What a search found at the default values of parameters and inputs; ``reason``: why there was none."""

    found: Equilibria | None = field(repr=False)
    reason: str = ""

    @property
    def places(self) -> list[Equilibrium]:
        """All that were found, stable ones first."""
        return sorted(self.found or (), key=lambda place: VERDICTS.index(place.verdict))


def rest_of(model: Model) -> Rest:
    """Positions of rest at the default values, from zero and STARTS random places, where the search is quick: up to
    MOST_COORDINATES coordinates and MOST_OPERATIONS operations.
    """
    if model.dof > MOST_COORDINATES or len(model.program) > MOST_OPERATIONS:
        size = f"{model.dof} coordinates and {len(model.program):,} operations"
        return Rest(None, f"{size}; the limits are {MOST_COORDINATES} and {MOST_OPERATIONS:,}")
    try:
        return Rest(equilibria(model, count=STARTS))
    except (InvalidInput, MissingValue, TooLarge, VerificationFailed) as error:
        return Rest(None, reason_of(error))


def rest_statements(model: Model, names: Names, rest: Rest, address: str) -> Iterator[Statement]:
    """How many positions of rest were found; of the first TOLD the verdict with its reason, frequencies [Hz], periods
    and times [s]; coordinates on which nothing depends. ``address``: of the tree, for requests that tell more.
    """
    request = f"POST {address}/equilibria" if address else ""
    if rest.found is None:
        text = f"Positions of rest were not looked for: {in_short(rest.reason, model, names)}."
        yield Statement("rest", "not-searched", text, request=request)
        return
    places = rest.places
    counted = listed(f"{n} {verdict}" for verdict, n in Counter(place.verdict for place in places).items())
    given = ", inputs at their defaults or 0" if model.input_names else ""
    text = f"Positions of rest found from {STARTS + 1} starts, parameters at their default values{given}: "
    told = f"{len(places)} ({counted})" if places else "none"
    why = f"; {in_short(rest.found.message, model, names)}" if rest.found.message else ""
    more = f"; the first {TOLD} follow" if len(places) > TOLD else ""
    figures = (Figure("starts", STARTS + 1, "1"), Figure("found", len(places), "1"))
    yield Statement("rest", "searched", f"{text}{told}{why}{more}.", figures=figures, request=request)
    held = rest.found.held
    if places and held:
        text = f"No force depends on {listed(names[c] for c in held)}: rest is at any value."
        yield Statement("rest", "held", text, coordinates=held, request=request)
    for place in places[:TOLD]:
        yield _judged(model, names, place, held, request)
    if any(place.verdict == "undecided" for place in places):
        yield from _relative(model, names, held, address)


def _cyclic(model: Model, held: tuple[str, ...]) -> list[str]:
    """Those on which neither the metric nor forces depend."""
    found, outputs = Dependence(model.program), [model.program.outputs[name] for name in ("metric", "forces")]
    used = {name for output in outputs for entry in output.entries for name in found.of(entry, held)}
    return [name for name in held if name not in used]


def _relative(model: Model, names: Names, held: tuple[str, ...], address: str) -> Iterator[Statement]:
    """Rest at constant momenta of cyclic coordinates that is stable by Routh's theorem, where that of all was
    undecided.
    """
    cyclic = _cyclic(model, held)
    if not cyclic or len(cyclic) == model.dof:
        return
    try:
        motions = steady_motions(model, momenta=dict.fromkeys(cyclic, 0.0), count=STARTS).found
    except (InvalidInput, MissingValue, TooLarge, VerificationFailed):
        return
    request = f"POST {address}/steady-motions" if address else ""
    kept = listed(names[c] for c in cyclic)
    stable = [motion for motion in motions if motion.verdict in ("asymptotically stable", "stable")]
    for motion in stable[:TOLD]:
        others = [(c, x) for c, x in zip(model.coordinates, motion.q.tolist(), strict=True) if c not in cyclic]
        units = {c: "rad" if kind == "R" else "m" for c, kind in zip(model.coordinates, model.joints, strict=True)}
        at = [(c, round(x, 9) + 0.0) for c, x in others]
        where = listed(f"{names[c]} = {x:.4g} {units[c]}" for c, x in at)
        text = (
            f"At constant momenta of the cyclic {kept}, rest of the others at {where} is {motion.verdict} because "
            f"{'' if motion.stability is None else motion.stability.reason}."
        )
        figures = tuple(Figure(c, x, units[c]) for c, x in at)
        code = f"relative-{motion.verdict.replace(' ', '-')}"
        yield Statement("rest", code, text, (), tuple(c for c, _ in at), figures, request)


def _judged(model: Model, names: Names, place: Equilibrium, held: tuple[str, ...], request: str) -> Statement:
    """A place with its verdict, why, and the motions beside it."""
    units = {name: "rad" if kind == "R" else "m" for name, kind in zip(model.coordinates, model.joints, strict=True)}
    # no -0 and no rounding errors of zero
    q = {name: round(x, 9) + 0.0 for name, x in zip(model.coordinates, place.q.tolist(), strict=True)}
    moving = [name for name in model.coordinates if name not in held]
    where = f" at {listed(f'{names[c]} = {q[c]:.4g} {units[c]}' for c in moving)}" if moving else ""
    limits = joint_limits(model).plain()
    left = [names[c] for c in moving if c in limits and not limits[c][0] <= q[c] <= limits[c][1]]
    where += f" (outside the limits of {listed(left)})" if left else ""
    figures = [Figure(name, q[name], units[name]) for name in moving]
    if place.at.stability is None:
        why = place.at.message or "it has no linearisation"
        text = f"Rest{where} is not judged because {in_short(why, model, names)}{_singular(place, figures)}."
        return Statement("rest", "failed", text, (), tuple(moving), tuple(figures), request)
    beside = "".join(f"; {text}" for text in (_vibrations(place.at.modes, figures), _rate(place, figures)) if text)
    text = f"Rest{where} is {place.verdict} because {place.at.stability.reason}{beside}."
    return Statement("rest", place.verdict.replace(" ", "-"), text, (), tuple(moving), tuple(figures), request)


def _singular(place: Equilibrium, figures: list[Figure]) -> str:
    """How nearly singular the metric is."""
    if not len(place.at.M) or not np.isfinite(place.at.M).all():
        return ""
    # least over largest singular value of g
    sizes = np.linalg.svd(place.at.M, compute_uv=False)
    figures.append(Figure("metric_condition", float(sizes[-1] / sizes[0]) if sizes[0] else 0.0, "1"))
    return f"; the least singular value of the mass matrix is {figures[-1].value:.2g} of its largest"


def _vibrations(found: tuple[Mode, ...], figures: list[Figure]) -> str:
    """Frequency, period and damping of what swings without growing."""
    told = []
    for mode in found:
        if mode.hertz and mode.damping_ratio >= -1e-6:
            damped = mode.damping_ratio > 1e-6
            figures += [Figure("frequency", mode.hertz, "Hz"), Figure("period", 1 / mode.hertz, "s")]
            figures += [Figure("damping_ratio", mode.damping_ratio, "1")] if damped else []
            ratio = f", damping ratio {mode.damping_ratio:.3g}" if damped else ""
            told.append(f"{mode.hertz:.4g} Hz (period {1 / mode.hertz:.4g} s{ratio})")
    return f"small vibrations of {listed(told, 8)}" if told else ""


def _rate(place: Equilibrium, figures: list[Figure]) -> str:
    """How fast the slowest motion dies out, or the fastest one grows: 1/|Re z| of the rightmost eigenvalue z."""
    if place.verdict not in ("asymptotically stable", "unstable"):
        return ""
    time = 1 / abs(max(mode.eigenvalue.real for mode in place.at.modes))
    figures.append(Figure("time_constant", time, "s"))
    what = "the fastest motion grows e-fold" if place.verdict == "unstable" else "the slowest motion falls to 1/e"
    return f"{what} in {time:.4g} s"
