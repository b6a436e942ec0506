"""What follows from the equations of motion, by name: formulas and numbers, for routes, jobs and the command line."""
