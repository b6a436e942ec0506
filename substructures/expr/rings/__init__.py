"""Rings in which formulas are evaluated exactly: canonical forms, and fields modulo primes."""
