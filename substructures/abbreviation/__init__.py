"""Formulas with what is negligible left out, and a proof of how wrong they can be (notation.md, section 11)."""
