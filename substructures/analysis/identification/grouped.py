"""The equations of motion in base parameters: a change of binding, after which no mass is counted twice.

With Y pi = Y_B beta and beta = [1 C] pi (:mod:`.base_parameters`) a tree whose links have the inertial parameters
pi_B = beta, pi_D = 0 moves as the tree itself: g_ab, Gamma_abc, the gravity forces and all that is made of them are the
same functions. The stored formulas of the parts take these parameters in place of what their bodies have of their own,
payloads included; nothing is derived again. What is not determined by motion (potential energy up to a constant,
momenta in the world, reactions) is not given.

Source: M. Gautier and W. Khalil, Direct calculation of minimum set of inertial parameters of serial robots, IEEE
Transactions on Robotics and Automation 6(3), 1990.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.certificate.compare import compare
from substructures.certificate.linear import Ball
from substructures.certificate.outputs import Outputs
from substructures.certificate.rebuilt import outputs_of
from substructures.certificate.states import states_between
from substructures.errors import TooLarge, VerificationFailed
from substructures.expr.direct import ball
from substructures.expr.graph import Expr, Graph
from substructures.expr.hoist import hoisted
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import constant_rotation
from substructures.mechanics.linear3 import SYMMETRIC_INDEX, Scalar
from substructures.mechanics.state_names import inertia_names
from substructures.part.outputs import OWN_INERTIA, PartOutputs, over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.printers.names import MAX_COMMENT
from substructures.printers.render import INLINE_LIMIT
from substructures.printers.text import Text
from substructures.printers.textbook import textbook_inlined
from substructures.tree.assembly import Assembly, assemble
from substructures.tree.couple import loaded_outputs
from substructures.tree.coupling import couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model
from substructures.tree.mounted_part import MountedPart

#: outputs of a model that base parameters determine
OUTPUTS = ("metric", "christoffel", "gravity", "forces", "bias", "nonlinear_effects", "inverse_dynamics")
#: ten values of a carrier, of which those that are not zero stand here by the name of the standard parameter
_Values = Mapping[str, Expr]


@dataclass(frozen=True)
class GroupedSymbol:
    """A symbol that stands for a base parameter: ``formula`` in parameters, ``standard``: coefficient (text) by
    standard parameter, what was grouped into it; ``named_by``: the first of these.
    """

    name: str
    unit: str
    named_by: str
    formula: str
    standard: Mapping[str, str] = field(hash=False)


@dataclass(frozen=True)
class Grouped:
    """A model in grouped symbols, which are parameters of it without a value. ``definitions``: an output for each, by
    its name, as a function of the parameters of the tree.
    """

    model: Model
    symbols: tuple[GroupedSymbol, ...]
    definitions: Program


def grouped_model(
    spec: TreeSpec, parts: Mapping[str, Part], model: Model, base: BaseParameters, max_nodes: int = MAX_NODES
) -> Grouped:
    """Those outputs OUTPUTS that a model has, with a symbol for every base parameter that is more than one parameter.

    ``model``: the tree as it was coupled; ``base``: its base parameters without drives. A base parameter that is a
    number, or a single parameter of the tree, stands for itself. Raises TooLarge for more than ``max_nodes``
    operations, VerificationFailed unless the formulas are those of the model.
    """
    assembly = assemble(spec, parts)
    definitions, values, named_by = _symbols(assembly, base)
    pairs = zip(assembly.mounted, assembly.instances, strict=True)
    opened = [_opened(m, instance.name, values) for m, instance in pairs]
    # models that were stored before one of these was an output do not have it
    names = [name for name in OUTPUTS if name in model.program.outputs]
    result = hoisted(_coupled(replace(assembly, mounted=tuple(opened)), names))
    if len(result) > max_nodes:
        raise TooLarge("the grouped formulas (in operations)", len(result), max_nodes)
    _certify(model, result, definitions)
    symbols = tuple(_described(base, definitions, named_by))
    own = {s.name: {"value": None, "unit": s.unit, "description": sum_of(s.standard)} for s in symbols}
    return Grouped(replace(model, program=result, parameters={**model.parameters, **own}), symbols, definitions)


def _symbols(assembly: Assembly, base: BaseParameters) -> tuple[Program, _Values, dict[str, str]]:
    """The definitions of new symbols, which are declared, the value of every base parameter that is not zero, and the
    standard parameter that a symbol is named by.
    """
    graph, values, outputs = Graph(), dict[str, Expr](), dict[str, Formulas]()
    named_by: dict[str, str] = {}
    symbols = {s.name: s for s in base.program.symbols}
    beta = replay(base.program, graph, {}, ["base_parameters"])["base_parameters"].entries
    here = assembly.scope.graph
    for (k,), x in beta.items():
        name = base.names[k]
        if x.op in ("sym", "int", "rat"):
            values[name] = here.symbol(str(x.value)) if x.op == "sym" else here.lift(x.value)
            continue
        called = _free_name(name, assembly)
        values[name] = assembly.scope.declare(called, "parameter", base.units[base.base[k]])
        outputs[called], named_by[called] = Formulas((), {(): x}), name
    return program(graph, outputs, symbols), values, named_by


def _free_name(standard: str, assembly: Assembly) -> str:
    """``arm.Jxx_link2`` of the base parameter ``arm.link2.Jxx``, where nothing else is called that."""
    instance, body, entry = standard.split(".")
    name = f"{instance}.{entry}_{body}"
    while name in assembly.scope.symbols or name in assembly.parameters:
        name += "_b"
    return name


def _opened(m: MountedPart, instance: str, values: _Values) -> MountedPart:
    """A mounted part with base parameters in place of what its bodies have of their own.

    Symbols ``own.<body>.m``, ... take the place of the outputs ``inertia``; what is fixed to the interface is counted
    with what carries it.
    """
    part, graph = m.part, Graph()
    formulas = replay(part.program, graph, {})
    symbols = {s.name: s for s in part.program.symbols}
    bindings = dict(m.bindings)
    frames = list(part.topology.carrier.values())
    bodies = list(part.topology.carrier)
    own = PartOutputs(formulas)
    carried = {name: dict[tuple[int, ...], Scalar]() for name in OWN_INERTIA}
    for k in sorted(part.inertia_symbols):
        frame = frames.index(k)
        pairs = inertia_names(f"own.{bodies[frame]}")
        for (name, unit), (standard, _) in zip(pairs, inertia_names(f"{instance}.{bodies[frame]}"), strict=True):
            symbols[name] = Symbol(name, "parameter", unit)
            bindings[name] = values.get(standard, 0)
        mass, sx, sy, sz, xx, yy, zz, xy, xz, yz = (graph.symbol(name) for name, _ in pairs)
        # from the frame that the link is named by to the body frame of its carrier
        inertia = Inertia(mass, (sx, sy, sz), (xx, yy, zz, xy, xz, yz)).in_parent(
            constant_rotation(own.matrix("frame.E", frame)), own.vector("frame.position", frame)
        )
        _put(carried, "inertia", (k,), inertia)
    changed = {name: Formulas(formulas[name].shape, some) for name, some in carried.items()}
    return replace(m, part=replace(part, program=program(graph, {**formulas, **changed}, symbols)), bindings=bindings)


def _put(outputs: Mapping[str, dict[tuple[int, ...], Scalar]], name: str, lead: tuple[int, ...], x: Inertia) -> None:
    """m, s and the full matrix J at an index."""
    outputs[f"{name}.m"][lead] = x.m
    outputs[f"{name}.s"] |= {(*lead, i): x.s[i] for i in range(3)}
    outputs[f"{name}.J"] |= {(*lead, i, j): x.J[SYMMETRIC_INDEX[i][j]] for i in range(3) for j in range(3)}


def _coupled(assembly: Assembly, names: Sequence[str]) -> Program:
    """The named outputs of the tree; every mass stays where it is."""
    graph = assembly.scope.graph
    run, christoffel = over_formulas(graph), "christoffel" in names
    coupled = couple_parts(run, assembly.mounted, assembly.gravity, christoffel, group=lambda _: False)
    found = loaded_outputs(assembly, coupled, frozenset(names))
    return program(graph, {name: found[name] for name in names}, assembly.scope.symbols)


def _certify(model: Model, result: Program, definitions: Program) -> None:
    """Raise VerificationFailed unless the formulas are those of the model, for beta of its parameters."""
    kinds = {s.name: s.kind for s in (*model.program.symbols, *result.symbols, *definitions.symbols)}
    kinds = {name: kind for name, kind in kinds.items() if name not in definitions.outputs}
    given = {name: parameter.get("value") for name, parameter in model.parameters.items()}
    defaults = {name: ball(value, precision=1100) for name, value in given.items() if value is not None}

    def expected(values: Mapping[str, Ball]) -> Outputs:
        """The grouped formulas at a state."""
        beta = {name: x.entries[()] for name, x in outputs_of(definitions, values).items()}
        return outputs_of(result, {**values, **beta})

    source = model.program.select(list(result.outputs))
    try:
        compare(source, kinds, expected, defaults, states_between(source.operations, result.operations))
    except VerificationFailed as error:
        raise VerificationFailed(f"grouped formulas: {error}") from None


def _described(base: BaseParameters, definitions: Program, named_by: Mapping[str, str]) -> Iterator[GroupedSymbol]:
    """What every symbol stands for. Raises TooLarge for what is too long to be told."""
    combinations = base.combinations()
    units = dict(zip(base.standard, base.units, strict=True))
    told = formulas_of(definitions)
    for name in definitions.outputs:
        standard = named_by[name]
        yield GroupedSymbol(name, units[standard], standard, told[name], combinations[standard])


def formulas_of(definitions: Program) -> dict[str, str]:
    """The textbook form of every definition, in the names of the tree. Raises TooLarge."""
    told = textbook_inlined(definitions, Text(definitions), INLINE_LIMIT).entries
    return {name: some[0] if some else "0" for name, some in told.items()}


def cut(text: str) -> str:
    """A sum in one line of a comment, cut between two terms where it is long."""
    return text if len(text) < MAX_COMMENT - 20 else text[: MAX_COMMENT - 20].rpartition(" + ")[0] + " + ..."


def sum_of(standard: Mapping[str, str]) -> str:
    """A combination as a text: ``arm.upper.Jxx + arm.l1^2*arm.lower.m``."""
    found = ""
    for name, c in standard.items():
        c, sign = (c[1:], "-") if _is_negative(c) else (c, "+")
        product = name if c == "1" else f"{f'({c})' if ' ' in c else c}*{name}"
        found += f" {sign} {product}" if found else (f"-{product}" if sign == "-" else product)
    return found


def _is_negative(text: str) -> bool:
    """Whether a text is the negative of a single term."""
    return text.startswith("-") and " " not in text
