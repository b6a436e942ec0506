"""What follows from metric, Christoffel symbols and forces: motion, closed loops, stability, optimal control.

Functions take a model and named arguments: numbers, arrays, frozen values such as ``Event`` and ``Table``; results are
frozen values of arrays. Arguments that cannot be used raise InvalidArgument with their name as pointer (``arguments``).

===============  ===================================================================================================
folder           what is there
===============  ===================================================================================================
simulate         ``simulate``: motions of trees, closed loops and rolling bodies; ``drawings``: results as diagrams
stability        positions of rest, steady motions; M, D, K and A, B, C, D, modes (``vibrations``), stability; root loci
control          equations of the adjoint as formulas; the gradient of a cost; optimal control by shooting
identification   which inertial parameters the motion depends on, and their values from measurements
closed           ``loops``: mobility, redundancy, reactions at a state; motions that stay on the closures
                 (``constrained``: the equations at a state, ``projection``: consistent states, ``reductions``: to
                 ordinary differential equations, ``prescribed``: motions that are given)
motion           ``problem``: what a motion is computed from (``signals``, ``events``, ``output_times``);
                 ``conditions``: the same in numbers and compiled formulas; ``integration`` and ``steppers``;
                 ``corners``: force laws on one side of them; ``judges`` and ``trajectory``: checks and results;
                 ``second_run``, ``single_steps``: judge what no first integral does; ``limits``;
                 ``parameter_sensitivity``; ``writers``: trajectories as files
equations        ``quasi_velocities``: Voronets and Boltzmann-Hamel; ``first_integrals`` (``energy``: its rule;
                 ``symmetries``); ``perturbation``, ``curvature``, ``routh``; ``dependencies``: exact linear
                 dependencies between functions; ``formulas``: a model in a new graph
report           a model told in words: structure, symmetries, sizes of terms; as text, LaTeX, a page
verdict          what checks found, and what they say together: right, wrong, or nobody knows
===============  ===================================================================================================
"""
