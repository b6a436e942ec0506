"""What people rather see than read, as SVG: trees in a pose, diagrams over a common axis."""
