"""Optimal control: the problem, the adjoint gradient, shooting as a nonlinear program."""
