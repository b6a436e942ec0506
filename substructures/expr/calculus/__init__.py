"""Integrals of formulas, and where they and their derivatives vanish or have corners."""
