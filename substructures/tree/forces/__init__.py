"""Forces in a tree: loads of the tree and of its parts, what carries them, potentials, and velocity forces."""
