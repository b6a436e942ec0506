"""Batch jobs: items in the database, computed by processes that can be killed."""
