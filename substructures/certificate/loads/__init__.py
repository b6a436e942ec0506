"""What loads have to do, by virtual power: those of definitions and of trees, and their potentials."""
