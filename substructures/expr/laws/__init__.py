"""Functions of force laws (abs, min, tanh, step, tables, powers): as formulas, and as values straight from the text."""
