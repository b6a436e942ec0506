"""Optimal control: gradients by the adjoint, and controls of least cost.

=================  ===================================================================================================
module             what is there
=================  ===================================================================================================
problem            ``ControlProblem`` and ``Cost``: what is controlled, what it costs, and for how long
holding            rows of closures or of velocity constraints that hold motions
adjoint            ``adjoint_equations``: the costates' equations as formulas
shooting           motions under controls and derivatives of their cost, exact for the computed motion
step_error         what the size of the steps makes of cost, motion and gradient, by a second run
cost_gradient      ``cost_gradient``: J of given controls and dJ
path_limits        expressions that stay within limits along the motion
demands            ``Demands`` and ``End``: what must hold, and what is unknown beside the controls
warm_start         an earlier result as the start of a search
nonlinear_program  variables, conditions and their derivatives of direct multiple shooting
optimal_control    ``optimal_control``: solves it, and judges the result by the necessary conditions
=================  ===================================================================================================
"""
