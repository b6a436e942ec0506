"""A tree becomes a part: its formulas, loads and names as a host sees them."""
