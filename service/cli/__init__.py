"""The command ``substructures``: its frame, and what its commands share."""
