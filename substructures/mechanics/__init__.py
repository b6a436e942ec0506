"""The algebraised Lagrange formalism over any scalar (formulas, floats, arrays)."""
