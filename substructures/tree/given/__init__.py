"""Coordinates that are given: their motion (driven), or their momentum (ignored)."""
