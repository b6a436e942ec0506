"""Rows of Denavit-Hartenberg parameters, straight to definitions: tables, SYMORO files, and where they are cut."""
