"""What formulas that are derived of a model or of its parts have to be."""
