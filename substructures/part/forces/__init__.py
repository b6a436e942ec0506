"""Loads of a part: read, and what they do as generalised forces."""
