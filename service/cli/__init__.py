"""The command ``substructures``: one file a group of commands."""
