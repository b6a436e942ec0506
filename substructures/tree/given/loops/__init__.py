"""Loops of parts: dependent coordinates as functions of independent ones (notation.md, section 10)."""
