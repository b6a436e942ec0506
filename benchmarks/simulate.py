"""Time of a simulation at equal accuracy, beside heyoka by itself, SciPy on SymPy's right-hand side, and MuJoCo.

Spatial revolute chains fall freely. Every engine is run with tighter and tighter settings; for each accuracy the
fastest run that reaches it against a tight reference counts.
``python -m benchmarks.simulate [--links N ...] [--json FILE] [--picture FILE]``: the picture is the work-precision
diagram, a panel for every chain.
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
from benchmarks.kane import derive_by_kane
from benchmarks.report import keep, options
from substructures import couple, derive
from substructures.analysis.from_fields import motion_arguments
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.integrators.compiled_steps import compiled_stepper
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.problems.problem import TAYLOR, Start
from substructures.analysis.motion.right_hand_side import RightHandSide, forward_dynamics
from substructures.analysis.motion.simulation import DYNAMICS
from substructures.analysis.motion.taylor import taylor_stepper
from substructures.analysis.simulate import FixedStep, Integrator, Outputs, simulate
from substructures.compile import compile_program
from substructures.pictures.plot import Line, Panel, plot
from substructures.tree.model import Model

Array = Any
SPAN = 5.0
TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
GRAVITY = 9.81
LEAST = 1e-12  # error that is looked at: the reference has some, too


@dataclass(frozen=True)
class Chain:
    """Rows, numbers of all parameters, and the start."""

    rows: list[dict[str, Any]]
    numbers: dict[str, float]
    q: Array
    qd: Array

    @classmethod
    def random(cls, n: int) -> Chain:
        """Bodies of eight mass points each."""
        rng = np.random.default_rng(7)
        numbers: dict[str, float] = {"g": GRAVITY}
        for i in range(1, n + 1):
            numbers |= {f"{x}{i}": float(rng.uniform(0.3, 0.9)) for x in ("alpha", "a", "d", "phi")}
            m, x = rng.uniform(0.1, 0.4, 8), rng.uniform(-0.3, 0.3, (8, 3))
            centre = m @ x / m.sum()
            J = np.einsum("k,ki,kj->ij", m, x - centre, x - centre)  # noqa: N806 -- symbols of the notation
            theta = np.trace(J) * np.eye(3) - J
            numbers |= {f"m{i}": float(m.sum())} | {f"c{e}{i}": float(c) for e, c in zip("xyz", centre, strict=True)}
            numbers |= {f"I{e}{i}": float(theta["xyz".index(e[0]), "xyz".index(e[1])]) for e in TENSOR}
        return cls(general_rows(n), numbers, rng.uniform(-0.5, 0.5, n), rng.uniform(-0.5, 0.5, n))

    def model(self) -> Model:
        """Coupled, parameters symbolic."""
        definition = chain("chain", self.rows)
        return couple(row_of([definition]), {"p0": derive(definition)})

    def xml(self) -> str:
        """The same in MuJoCo's language; contacts and constraints off."""
        inner = ""
        v = self.numbers
        for i in reversed(range(1, len(self.rows) + 1)):
            alpha, a, d, phi = (v[f"{x}{i}"] for x in ("alpha", "a", "d", "phi"))
            position = f"{a!r} {-np.sin(alpha) * d!r} {np.cos(alpha) * d!r}".replace("np.float64(", "").replace(")", "")
            half = (np.cos(alpha / 2), np.sin(alpha / 2)), (np.cos(phi / 2), np.sin(phi / 2))
            (ca, sa), (cp, sp) = half
            quaternion = " ".join(repr(float(x)) for x in (ca * cp, sa * cp, -sa * sp, ca * sp))
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


def ours(model: Model, system: Chain, method: str) -> list[Run]:
    """simulate: compiled right-hand side, with the drift of all first integrals."""
    numbers = parameters(model, system)
    base = {"q": system.q, "qd": system.qd, "span": [0, SPAN], "count": 2, "parameters": numbers, "method": method}

    def once(k: int) -> Array:
        request = base | {"relative_tolerance": 10.0**-k, "absolute_tolerance": 10.0 ** -(k + 1)}
        return simulate(model, **motion_arguments(model, **request)).q[-1]

    start = perf_counter()
    once(6)
    print(f"{method}: {perf_counter() - start:.2f} s for the first run, which compiles")
    return [timed(f"1e-{k}", lambda k=k: once(k)) for k in range(4, 14)]


def without_verdict(model: Model, system: Chain) -> list[Run]:
    """The motion that simulate judges, by itself."""
    f, x = right_hand_side(model, system), np.concatenate([system.q, system.qd])

    def once(k: int) -> Array:
        settings = IntegratorSettings(compiled_stepper("DOP853", 10.0**-k, 10.0 ** -(k + 1)), 1_000_000)
        return integrate(f, x, (0.0, SPAN), np.array([0.0, SPAN]), settings).x[-1][: f.n]

    return [timed(f"1e-{k}", lambda k=k: once(k)) for k in range(4, 14)]


def heyoka_by_itself(model: Model, system: Chain) -> list[Run]:
    """The Taylor series of the same formulas, propagated by heyoka from the start to the end."""
    start = Start(q=system.q, qd=system.qd, parameters=parameters(model, system)).with_defaults(model)
    conditions, x = read_conditions(model, start, (0.0, SPAN), DYNAMICS), np.concatenate([system.q, system.qd])

    def made(k: int) -> Callable[[], Array]:
        stepper = taylor_stepper(conditions, 10.0**-k, has_power=False)(None, 0.0, x, SPAN)

        def once() -> Array:
            stepper.integrator.time, stepper.integrator.state[:] = 0.0, x
            stepper.integrator.propagate_until(SPAN)
            return stepper.integrator.state[: len(system.q)].copy()

        return once

    return [timed(f"1e-{k}", made(k)) for k in range(4, 14)]


def parameters(model: Model, system: Chain) -> dict[str, float]:
    """Numbers of the parameters of the tree."""
    return {name: system.numbers[name.removeprefix("p0.")] for name in model.parameters}


def right_hand_side(model: Model, system: Chain) -> RightHandSide:
    """x' = f(t, x), inputs zero."""
    return RightHandSide(model, parameters(model, system), [s.name for s in model.program.symbols if s.kind == "input"])


def ours_fixed(model: Model, system: Chain) -> list[Run]:
    """simulate with fixed steps of the classical Runge-Kutta method."""
    numbers = parameters(model, system)
    base = {"q": system.q, "qd": system.qd, "span": [0, SPAN], "parameters": numbers, "outputs": Outputs(count=2)}
    steps = [SPAN / (250 * 2**k) for k in range(7)]
    ways = [(h, Integrator(FixedStep(h))) for h in steps]
    return [timed(f"h = {h:.1e}", lambda way=way: simulate(model, **base, integrator=way).q[-1]) for h, way in ways]


def sympy_function(system: Chain) -> Callable[[float, Array], Array]:
    """KanesMethod's mass matrix and forcing by lambdify with common subexpressions."""
    n = len(system.rows)
    M, forcing = derive_by_kane(system.rows)  # noqa: N806 -- symbols of the notation
    numbers = {sympy.Symbol(name): value for name, value in system.numbers.items()}
    q, u = dynamicsymbols(f"q1:{n + 1}"), dynamicsymbols(f"u1:{n + 1}")
    plain = sympy.symbols(f"s0:{2 * n}")
    names = dict(zip([*q, *u], plain, strict=True))
    generated = sympy.lambdify([plain], [M.subs(numbers).subs(names), forcing.subs(numbers).subs(names)], cse=True)

    def f(_: float, x: Array) -> Array:
        mass, right = generated(x)
        return np.concatenate([x[n:], np.linalg.solve(mass, right[:, 0])])

    return f


def scipy_on_sympy(f: Callable[[float, Array], Array], system: Chain) -> list[Run]:
    """The same integrator, DOP853."""
    x, n = np.concatenate([system.q, system.qd]), len(system.q)

    def once(k: int) -> Array:
        return solve_ivp(f, (0, SPAN), x, "DOP853", rtol=10.0**-k, atol=10.0 ** -(k + 1)).y[:n, -1]

    return [timed(f"1e-{k}", lambda k=k: once(k)) for k in range(4, 14)]


def in_mujoco(system: Chain) -> list[Run]:
    """Its Runge-Kutta method of fourth order, the loop over the steps inside MuJoCo."""
    model = mujoco.MjModel.from_xml_string(system.xml())
    data = mujoco.MjData(model)

    def once(steps: int) -> Array:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = system.q, system.qd
        model.opt.timestep = SPAN / steps
        mujoco.mj_step(model, data, nstep=steps)
        return data.qpos.copy()

    return [timed(f"h = {SPAN / s:.1e}", lambda s=s: once(s)) for s in (250 * 2**k for k in range(11))]


def evaluation_times(model: Model, system: Chain, peer: Callable[[float, Array], Array]) -> dict[str, float]:
    """One right-hand side [us], and compiling [ms]."""
    inputs = [s.name for s in model.program.symbols if s.kind == "input"]
    start = perf_counter()
    source = forward_dynamics(model, inputs)
    compile_program(source, list(source.outputs))
    compiling = perf_counter() - start
    f, x = right_hand_side(model, system), np.concatenate([system.q, system.qd])
    times = {"compile_ms": compiling * 1e3}
    for name, function in (("rhs_ours_us", f), ("rhs_sympy_us", peer)):
        start = perf_counter()
        for _ in range(2000):
            function(0.0, x)
        times[name] = (perf_counter() - start) / 2000 * 1e6
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


def diagram(links: int, runs: dict[str, list[Run]], reference: Array) -> Panel:
    """Largest error at the end over the time it takes, both as powers of ten."""
    lines = []
    for name, some in runs.items():
        errors = np.array([np.abs(r.q - reference).max() for r in some])
        times = np.array([r.seconds for r in some])
        seen = (errors > LEAST) & (errors < 1)
        lines.append(Line(name, np.log10(times[seen] * 1e3), np.log10(errors[seen])))
    title = f"{links} links, {SPAN:g} s"
    return Panel(title, "lg of the time [ms]", "lg of the largest error at the end [rad]", tuple(lines))


def measured(links: int) -> tuple[dict[str, float], Panel]:
    """Figures of one chain, printed, and its diagram."""
    system = Chain.random(links)
    start = perf_counter()
    model = system.model()
    print(f"{links} links, {SPAN:g} s; derived and coupled in {(perf_counter() - start) * 1e3:.0f} ms")
    start = perf_counter()
    peer = sympy_function(system)
    derived = perf_counter() - start
    figures = evaluation_times(model, system, peer) | {"sympy_s": derived}
    print(f"SymPy: derived and lambdified in {derived:.1f} s; ours compiled in {figures['compile_ms']:.0f} ms")
    print(f"one right-hand side: {figures['rhs_ours_us']:.1f} us; SymPy's {figures['rhs_sympy_us']:.0f} us")
    runs = {"DOP853": ours(model, system, "DOP853"), "no verdict": without_verdict(model, system)}
    runs["RK4"] = ours_fixed(model, system)
    if find_spec("heyoka"):
        runs |= {"Taylor": ours(model, system, TAYLOR), "heyoka itself": heyoka_by_itself(model, system)}
    runs |= {"SciPy, SymPy": scipy_on_sympy(peer, system), f"MuJoCo {mujoco.__version__}": in_mujoco(system)}
    reference = runs["DOP853"][-1].q
    return figures | table(runs, reference), diagram(links, runs, reference)


def main() -> None:
    """Print the tables; with --json FILE write the figures."""
    parser = options(__doc__)
    parser.add_argument("--links", type=int, nargs="+", default=[3])
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    found = {links: measured(links) for links in arguments.links}
    keep({f"{n} links, {name}": x for n, (some, _) in found.items() for name, x in some.items()}, arguments.json)
    if arguments.picture:
        panels = [panel for _, panel in found.values()]
        arguments.picture.write_text(plot("Accuracy against time: free fall of chains", panels))


if __name__ == "__main__":
    main()
