"""Formulas that follow from g, Gamma and Q: first integrals, perturbation, Routh, quasi-velocities."""
