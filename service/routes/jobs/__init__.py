"""Jobs, their results and their events."""
