"""Time of a simulation at equal accuracy, beside heyoka, SciPy, and MuJoCo.

Spatial revolute chains fall freely for five seconds, the humanoid of the catalogue for half a second; with ``--stops``
also against a stiff stop in every joint, chains for two seconds. A stop is smooth, -k w log(1 + exp((q - q_0)/w)), so
that all can take it; MuJoCo does by a callback in Python. Every engine is run with tighter and tighter settings; for
each accuracy the fastest run that reaches it against a tight reference counts. SciPy's DOP853 calls our kernel, and of
up to four links that fall freely SymPy's lambdified function.
``python -m benchmarks.simulate [--links N ...] [--humanoid] [--stops] [--json FILE] [--picture FILE]``: the picture is
the work-precision diagram, a panel for every mechanism.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import Any

import mujoco
import numpy as np
import sympy
from scipy.integrate import solve_ivp
from sympy.physics.mechanics import dynamicsymbols

from benchmarks.chains import TENSOR, chain, general_rows, row_of
from benchmarks.derive import humanoid
from benchmarks.kane import derive_by_kane
from benchmarks.mujoco_robots import Twin
from benchmarks.report import keep, options
from benchmarks.robots import robots
from substructures import couple, derive
from substructures.analysis.from_fields import motion_arguments
from substructures.analysis.motion.integrators.compiled_steps import compiled_stepper
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.right_hand_side import RightHandSide, forward_dynamics
from substructures.analysis.plot import Line, Panel, plot
from substructures.analysis.simulate import FixedStep, Integrator, Outputs, simulate
from substructures.compile import compile_program
from substructures.tree.model import Model

Array = Any
SPAN, SPAN_OF_STOPS, SHORT_SPAN = 5.0, 2.0, 0.5
#: coordinates of the body that is free
FREE = 6
TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
GRAVITY = 9.81
LEAST = 1e-12  # error that is looked at: the reference has some, too
#: links of which SymPy's function is formed: of six it takes many minutes
SYMPY_LINKS = 4
#: of a stop: k [N m/rad] and w [rad]; q_0 [rad] of chains, and of the humanoid
STIFFNESS, WIDTH = 2000, 0.002
PLACE, NEAR = 1.0, 0.25


@dataclass(frozen=True)
class Mechanism:
    """What falls: its model, numbers of all parameters, the start, the time [s], and the same in MuJoCo, whose degree
    of freedom k is our coordinate ``order[k]``; ``rows``: of a chain that falls freely; ``stops`` (n,): their places.
    """

    title: str
    model: Model
    numbers: dict[str, float]
    q: Array
    qd: Array
    span: float
    twin: mujoco.MjModel
    order: list[int]
    rows: list[dict[str, Any]] | None = None
    stops: Array = None

    @property
    def x(self) -> Array:
        """The state at the start."""
        return np.concatenate([self.q, self.qd])

    def start_of(self, f: Callable[[float, Array], Array]) -> Array:
        """With the work of forces behind it, where a function has that, too."""
        return np.concatenate([self.x, np.zeros(f.size - len(self.x))]) if isinstance(f, RightHandSide) else self.x

    @classmethod
    def chain(cls, n: int, stops: bool = False) -> Mechanism:
        """Links of eight mass points each, coupled, parameters symbolic."""
        rng, rows = np.random.default_rng(7), general_rows(n)
        numbers: dict[str, float] = {"g": GRAVITY}
        for i in range(1, n + 1):
            numbers |= {f"{x}{i}": float(rng.uniform(0.3, 0.9)) for x in ("alpha", "a", "d", "phi")}
            m, x = rng.uniform(0.1, 0.4, 8), rng.uniform(-0.3, 0.3, (8, 3))
            centre = m @ x / m.sum()
            J = np.einsum("k,ki,kj->ij", m, x - centre, x - centre)  # noqa: N806 -- symbols of the notation
            theta = np.trace(J) * np.eye(3) - J
            numbers |= {f"m{i}": float(m.sum())} | {f"c{e}{i}": float(c) for e, c in zip("xyz", centre, strict=True)}
            numbers |= {f"I{e}{i}": float(theta["xyz".index(e[0]), "xyz".index(e[1])]) for e in TENSOR}
        loads = [
            {"type": "joint", "coordinate": f"q{i}", "force": _stop(f"q{i}", PLACE)} for i in range(1, n + 1) if stops
        ]
        definition = chain("chain", rows, loads=loads)
        model = couple(row_of([definition]), {"p0": derive(definition)})
        twin = mujoco.MjModel.from_xml_string(_xml(n, numbers))
        given = {name: numbers[name.removeprefix("p0.")] for name in model.parameters}
        q, qd = rng.uniform(-0.5, 0.5, n), rng.uniform(-0.5, 0.5, n)
        span = SPAN_OF_STOPS if stops else SPAN
        title = f"{n} links{', stiff stops' * stops}, {span:g} s"
        more = {"stops": np.full(n, PLACE)} if stops else {"rows": rows}
        return cls(title, model, given, q, qd, span, twin, list(range(n)), **more)

    @classmethod
    def humanoid(cls, stops: bool = False) -> Mechanism:
        """34 degrees of freedom, of a body that is free: without springs, as it is in the catalogue."""
        robot, rng = robots()[1], np.random.default_rng(7)
        twin, n = Twin.of(robot), robot.model.dof
        given = {name: robot.numbers[name] for name in robot.model.parameters}
        q, qd = rng.uniform(-0.2, 0.2, n), rng.uniform(-0.5, 0.5, n)
        twin.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        twin.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
        if not stops:
            title = f"humanoid, {n} dof, {SHORT_SPAN:g} s"
            return cls(title, robot.model, given, q, qd, SHORT_SPAN, twin.model, twin.order)
        spec, library = humanoid()
        turned = robot.model.coordinates[FREE:]
        loads = [
            {"name": f"stop{k}", "type": "joint", "coordinate": c, "force": _stop(c, NEAR)}
            for k, c in enumerate(turned)
        ]
        model = couple(
            spec.plain() | {"loads": loads}, {i.name: derive(library[str(i.substructure)]) for i in spec.instances}
        )
        places = np.append(np.full(FREE, np.inf), np.full(len(turned), NEAR))
        title = f"humanoid, {n} dof, stiff stops, {SHORT_SPAN:g} s"
        return cls(title, model, given, q, qd, SHORT_SPAN, twin.model, twin.order, stops=places)


def _stop(q: str, place: float) -> str:
    return f"-{STIFFNESS}*{WIDTH}*log(1 + exp(({q} - {place})/{WIDTH}))"


def _stopped(places: Array) -> Callable[[mujoco.MjModel, mujoco.MjData], None]:
    """The same for MuJoCo, of all joints."""

    def passive(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        with np.errstate(over="ignore"):
            data.qfrc_passive[:] -= STIFFNESS * WIDTH * np.logaddexp(0.0, (data.qpos - places) / WIDTH)

    return passive


def _xml(n: int, v: dict[str, float]) -> str:
    """A chain in MuJoCo's language; contacts and constraints off."""
    inner = ""
    for i in reversed(range(1, n + 1)):
        alpha, a, d, phi = (v[f"{x}{i}"] for x in ("alpha", "a", "d", "phi"))
        position = f"{a!r} {float(-np.sin(alpha) * d)!r} {float(np.cos(alpha) * d)!r}"
        (ca, sa), (cp, sp) = ((float(np.cos(x / 2)), float(np.sin(x / 2))) for x in (alpha, phi))
        quaternion = " ".join(repr(x) for x in (ca * cp, sa * cp, -sa * sp, ca * sp))
        tensor = " ".join(repr(v[f"I{e}{i}"]) for e in TENSOR)
        centre = " ".join(repr(v[f"c{e}{i}"]) for e in "xyz")
        inner = (
            f'<body pos="{position}" quat="{quaternion}"><joint type="hinge" axis="0 0 1"/>'
            f'<inertial pos="{centre}" mass="{v[f"m{i}"]!r}" fullinertia="{tensor}"/>{inner}</body>'
        )
    flags = '<flag contact="disable" constraint="disable"/>'
    return (
        f'<mujoco><compiler angle="radian"/><option gravity="0 0 {-GRAVITY}" integrator="RK4">{flags}</option>'
        f"<worldbody>{inner}</worldbody></mujoco>"
    )


@dataclass(frozen=True)
class Run:
    """One run: its setting, the coordinates at the end, and its time [s]."""

    setting: str
    q: Array
    seconds: float


def timed(setting: str, call: Callable[[], Array]) -> Run:
    """The best of three."""
    best, q = np.inf, None
    for _ in range(3):
        start = perf_counter()
        q = call()
        best = min(best, perf_counter() - start)
    return Run(setting, q, best)


def by_tolerance(once: Callable[[int], Array]) -> list[Run]:
    """Runs at 1e-4 to 1e-13."""
    return [timed(f"1e-{k}", lambda k=k: once(k)) for k in range(4, 14)]


def ours(system: Mechanism, method: str) -> list[Run]:
    """simulate: compiled right-hand side, with the drift of all first integrals."""
    base = {"q": system.q, "qd": system.qd, "span": [0, system.span], "count": 2, "parameters": system.numbers}

    def once(k: int) -> Array:
        tolerances = {"relative_tolerance": 10.0**-k, "absolute_tolerance": 10.0 ** -(k + 1)}
        return simulate(system.model, **motion_arguments(system.model, **base, method=method, **tolerances)).q[-1]

    start = perf_counter()
    once(6)
    print(f"{method}: {perf_counter() - start:.2f} s for the first run, which compiles")
    return by_tolerance(once)


def without_verdict(system: Mechanism) -> list[Run]:
    """The motion that simulate judges, by itself."""
    f = right_hand_side(system)

    def once(k: int) -> Array:
        settings = IntegratorSettings(compiled_stepper("DOP853", 10.0**-k, 10.0 ** -(k + 1)), 1_000_000)
        times = (0.0, system.span)
        return integrate(f, system.start_of(f), times, np.array(times), settings).x[-1][: f.n]

    return by_tolerance(once)


def heyoka_by_itself(system: Mechanism) -> list[Run]:
    """The Taylor series of the same formulas, propagated by heyoka from the start to the end."""
    from benchmarks.heyoka_series import integrator  # noqa: PLC0415 -- where it is installed

    def made(k: int) -> Callable[[], Array]:
        series = integrator(system.model, system.numbers, 10.0**-k)

        def once() -> Array:
            series.time, series.state[:] = 0.0, system.x
            series.propagate_until(system.span)
            return series.state[: len(system.q)].copy()

        return once

    return [timed(f"1e-{k}", made(k)) for k in range(4, 16)]


def right_hand_side(system: Mechanism) -> RightHandSide:
    """x' = f(t, x), inputs zero."""
    inputs = [s.name for s in system.model.program.symbols if s.kind == "input"]
    return RightHandSide(system.model, system.numbers, inputs)


def ours_fixed(system: Mechanism) -> list[Run]:
    """simulate with fixed steps of the classical Runge-Kutta method."""
    base = {"q": system.q, "qd": system.qd, "span": [0, system.span], "parameters": system.numbers}
    steps = [system.span / (10 * 2**k) for k in range(11)]

    def once(h: float) -> Array:
        return simulate(system.model, **base, outputs=Outputs(count=2), integrator=Integrator(FixedStep(h))).q[-1]

    return [timed(f"h = {h:.1e}", lambda h=h: once(h)) for h in steps]


def sympy_function(system: Mechanism) -> Callable[[float, Array], Array]:
    """KanesMethod's mass matrix and forcing by lambdify with common subexpressions."""
    n = len(system.q)
    M, forcing = derive_by_kane(system.rows)  # noqa: N806 -- symbols of the notation
    numbers = {sympy.Symbol(name.removeprefix("p0.")): value for name, value in system.numbers.items()}
    q, u = dynamicsymbols(f"q1:{n + 1}"), dynamicsymbols(f"u1:{n + 1}")
    plain = sympy.symbols(f"s0:{2 * n}")
    names = dict(zip([*q, *u], plain, strict=True))
    generated = sympy.lambdify([plain], [M.subs(numbers).subs(names), forcing.subs(numbers).subs(names)], cse=True)

    def f(_: float, x: Array) -> Array:
        mass, right = generated(x)
        return np.concatenate([x[n:], np.linalg.solve(mass, right[:, 0])])

    return f


def in_scipy(f: Callable[[float, Array], Array], system: Mechanism) -> list[Run]:
    """The same integrator, DOP853."""
    n = len(system.q)

    def once(k: int) -> Array:
        x, span = system.start_of(f), (0, system.span)
        return solve_ivp(f, span, x, "DOP853", rtol=10.0**-k, atol=10.0 ** -(k + 1)).y[:n, -1]

    return by_tolerance(once)


def in_mujoco(system: Mechanism) -> list[Run]:
    """Its Runge-Kutta method of fourth order, the loop over the steps inside MuJoCo."""
    data, place = mujoco.MjData(system.twin), np.argsort(system.order)
    mujoco.set_mjcb_passive(None if system.stops is None else _stopped(system.stops[system.order]))

    def once(steps: int) -> Array:
        mujoco.mj_resetData(system.twin, data)
        data.qpos[:], data.qvel[:] = system.q[system.order], system.qd[system.order]
        system.twin.opt.timestep = system.span / steps
        mujoco.mj_step(system.twin, data, nstep=steps)
        return data.qpos[place]

    return [timed(f"h = {system.span / s:.1e}", lambda s=s: once(s)) for s in (10 * 2**k for k in range(15))]


def evaluation_times(system: Mechanism, peers: dict[str, Callable[[float, Array], Array]]) -> dict[str, float]:
    """One right-hand side [us], and compiling [ms]."""
    inputs = [s.name for s in system.model.program.symbols if s.kind == "input"]
    start = perf_counter()
    source = forward_dynamics(system.model, inputs)
    compile_program(source, list(source.outputs))
    times = {"compile_ms": (perf_counter() - start) * 1e3}
    for name, function in ({"ours": right_hand_side(system)} | peers).items():
        x = system.start_of(function)
        start = perf_counter()
        for _ in range(2000):
            function(0.0, x)
        times[f"rhs_{name}_us"] = (perf_counter() - start) / 2000 * 1e6
    return times


def table(runs: dict[str, list[Run]], reference: Array) -> dict[str, float]:
    """For every accuracy the fastest run of every engine."""
    figures: dict[str, float] = {}
    print(f"{'largest error at the end':>34} {' '.join(f'{t:>16.0e}' for t in TARGETS)}")
    for name, some in runs.items():
        cells = []
        for target in TARGETS:
            good = [r for r in some if np.abs(r.q - reference).max() <= target]
            best = min(good, key=lambda r: r.seconds, default=None)
            cells.append("not reached" if best is None else f"{best.seconds * 1e3:.1f} ms {best.setting}")
            if best is not None:
                figures[f"{name}, {target:.0e}"] = best.seconds
        print(f"{name:>34} {' '.join(f'{c:>16}' for c in cells)}")
    return figures


def diagram(title: str, runs: dict[str, list[Run]], reference: Array) -> Panel:
    """Largest error at the end over the time it takes, both as powers of ten."""
    lines = []
    for name, some in runs.items():
        errors = np.array([np.abs(r.q - reference).max() for r in some])
        times = np.array([r.seconds for r in some])
        seen = (errors > LEAST) & (errors < 1)
        lines.append(Line(name, np.log10(times[seen] * 1e3), np.log10(errors[seen])))
    return Panel(title, "lg of the time [ms]", "lg of the largest error at the end [rad, m]", tuple(lines))


def measured(system: Mechanism) -> tuple[dict[str, float], Panel]:
    """Figures of one mechanism, printed, and its diagram."""
    print(f"\n{system.title}")
    peers: dict[str, Callable[[float, Array], Array]] = {}
    figures: dict[str, float] = {}
    if system.rows is not None and len(system.rows) <= SYMPY_LINKS:
        start = perf_counter()
        peers["SymPy"] = sympy_function(system)
        figures["sympy_s"] = perf_counter() - start
        print(f"SymPy: derived and lambdified in {figures['sympy_s']:.1f} s")
    figures |= evaluation_times(system, peers)
    print(", ".join(f"{name} {x:.3g}" for name, x in figures.items()))
    runs = {"DOP853": ours(system, "DOP853"), "no verdict": without_verdict(system), "RK4": ours_fixed(system)}
    if find_spec("heyoka"):
        runs["heyoka"] = heyoka_by_itself(system)
    runs["SciPy, our kernel"] = in_scipy(right_hand_side(system), system)
    runs[f"MuJoCo {mujoco.__version__}"] = in_mujoco(system)
    # last: the others have the same colours in all pictures
    runs |= {f"SciPy, {name}": in_scipy(f, system) for name, f in peers.items()}
    reference = runs["DOP853"][-1].q
    return figures | table(runs, reference), diagram(system.title, runs, reference)


def main() -> None:
    """Print the tables; with --json FILE write the figures."""
    parser = options(__doc__)
    parser.add_argument("--links", type=int, nargs="*", default=[3])
    parser.add_argument("--stops", action="store_true")
    parser.add_argument("--humanoid", action="store_true")
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    variants = (False, True) if arguments.stops else (False,)
    systems = [Mechanism.chain(n, stops) for n in arguments.links for stops in variants]
    systems += [Mechanism.humanoid(stops) for stops in variants if arguments.humanoid]
    found = {system.title: measured(system) for system in systems}
    keep({f"{title}, {name}": x for title, (some, _) in found.items() for name, x in some.items()}, arguments.json)
    if arguments.picture:
        panels = [panel for _, panel in found.values()]
        arguments.picture.write_text(plot("Accuracy against time", panels))


if __name__ == "__main__":
    main()
