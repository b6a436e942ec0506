"""Units of formulas: dimensions, and whether they agree."""
