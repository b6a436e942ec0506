"""Search in the catalogue: words and terms of a request, parts, trees, formulas."""
