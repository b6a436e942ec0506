"""Periodic orbits with their multipliers, Poincare sections, and Lyapunov exponents: whether motions come back, and how
fast neighbours part.
"""
