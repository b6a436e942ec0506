"""A file for each command, or for commands of one subject: its table ``COMMANDS`` has their functions by name."""
