"""What is asked of a motion: its start, what acts, its kind, how accurate it must be, and what of it is wanted."""
