"""Given motions and momenta from the text of a tree."""
