"""Coordinates that are given: by others (dependent), or their motion (driven), or their momentum (ignored)."""
