"""Periodic orbits with their multipliers, and Lyapunov exponents: what the linear neighbourhood of a motion tells."""
