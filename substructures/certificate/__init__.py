"""What stored formulas have to be, computed from the documents alone: the yardstick that they are certified by."""
