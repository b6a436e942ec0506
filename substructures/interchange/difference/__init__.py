"""How two definitions, parts or trees differ: fields of the documents, entries of the formulas, and both in words."""
