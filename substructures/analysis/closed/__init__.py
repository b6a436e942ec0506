"""Closed loops: consistent states, reactions, and motions that stay on the closures."""
