"""From a definition to stored, certified formulas of one part: U, Omega, metric and Christoffel symbols."""
