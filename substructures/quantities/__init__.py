"""What a model can be asked for one state or many: metric, Christoffel symbols, forces, dynamics, regressor."""
