"""Loops of parts in closed form: dependent coordinates as functions of independent ones (notation.md, section 10)."""
