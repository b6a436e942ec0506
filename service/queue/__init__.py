"""Hands queued items of jobs to whatever computes them, and keeps what ends."""
