"""What follows from metric, Christoffel symbols and forces: motion, stability, closed loops, optimal control.

=========================  =========================================================================================
module                     what is there
=========================  =========================================================================================
simulate                   ``simulate``: motions of trees, closed loops and rolling bodies, by the request
simulate_tree, _closed,    one each; ``parameter_sensitivity``: derivatives of a motion by parameters and start;
_rolling                   ``writers``: trajectories as files
loops                      ``analyse_loops``: mobility, redundancy, reactions at a state
quasi_velocities           ``quasi_velocity_equations``: Voronets and Boltzmann-Hamel as formulas
stability                  ``equilibria``, ``linearise``, ``root_locus``: positions of rest; M, D, K and A, B, C, D,
                           modes, stability; roots over a parameter; ``perturbation``: the same as formulas
first_integrals, routh     constants of the motion as formulas (``energy``: its rule); cyclic coordinates left out
curvature                  of the configuration space
control                    equations of the adjoint as formulas; the gradient of a cost; optimal control by shooting
identification             which inertial parameters the motion depends on, and their values from measurements
=========================  =========================================================================================

What simulations share: ``requests`` (documents; their parts: ``request_fields``), ``inputs`` (inputs, events, series of
a request), ``steppers`` and ``integrate`` (steps, outputs, events, breaks), ``judges`` and ``trajectory`` (checks and
results). Closed loops add ``constrained`` (the equations at a state), ``prescribed`` (motions that are given),
``project`` (consistent states), ``reductions`` and ``closed_stepper``; trees ``right_hand_side``, ``fixed_step`` and
``taylor``.
Expressions of documents are read by ``expressions``; ``formulas`` and ``formulation`` hold a model in a new graph.
"""
