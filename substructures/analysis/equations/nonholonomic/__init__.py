"""Velocity constraints B q' + b = 0: their rows, quasi-velocities, Voronets' and Boltzmann-Hamel equations."""
