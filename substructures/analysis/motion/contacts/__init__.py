"""Unilateral contacts with impacts: gaps and rows as formulas, complementarity, and motions in pieces between."""
