"""What follows from metric, Christoffel symbols and forces: motion, closed loops, stability, optimal control.

Functions take a model and a few arguments: numbers, arrays, frozen values such as ``Integrator`` and ``Outputs``, which
cannot be combined wrongly; results are frozen values of arrays. What cannot be used raises InvalidArgument with the
name of its field as pointer (``arguments``). Flat documents, as HTTP sends them, become arguments in ``from_fields``.

===============  ===================================================================================================
folder           what is there
===============  ===================================================================================================
simulate         ``simulate``: motions of trees, closed loops and rolling bodies; ``drawings``: results as diagrams
stability        positions of rest, steady motions; M, D, K and A, B, C, D, modes (``vibrations``), stability; root loci
orbits           periodic orbits, Poincare sections, Lyapunov exponents
control          equations of the adjoint as formulas; the gradient of a cost; optimal control by shooting
identification   which inertial parameters the motion depends on, and their values from measurements
closed           ``loops``: mobility, redundancy, reactions at a state; motions that stay on the closures
                 (``constrained``: the equations at a state, ``projection``: consistent states, ``reductions``: to
                 ordinary differential equations, ``prescribed``: motions that are given)
motion           ``problems``: what is asked of a motion (its kind, integrator, outputs, signals, events);
                 ``conditions``: the same in numbers and compiled formulas; ``integrators``; ``corners``: force laws on
                 one side of them; ``judges`` and ``trajectory``: checks and results; ``second_judges``
                 (``second_run``, ``single_steps``): judge what no first integral does; ``limits``;
                 ``parameter_sensitivity``; ``writers``: trajectories as files
equations        ``nonholonomic``: velocity constraints, Voronets and Boltzmann-Hamel; ``first_integrals`` (``energy``:
                 its rule; ``symmetries``); ``perturbation``, ``curvature``, ``routh``; ``dependencies``: exact linear
                 dependencies between functions; ``formulas``: a model in a new graph
continuation     curves F(u) = 0 by pseudo-arclength, and where two cross
report           a model told in words: structure, symmetries, sizes of terms; as text, LaTeX, a page
plot             lines over an axis as SVG
verdict          what checks found, and what they say together: right, wrong, or nobody knows
===============  ===================================================================================================
"""
