"""Submit jobs and uploads, watch them, read their results."""
