"""JSON of resources and jobs, as it goes out."""
