"""Jobs, their items, results, events and uploads; the queue of what is to be done."""
