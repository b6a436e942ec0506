"""Bodies of requests for analyses."""
