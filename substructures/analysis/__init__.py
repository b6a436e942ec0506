"""What follows from metric, Christoffel symbols and forces: motion, stability, closed loops, optimal control."""
