"""What happens where a node of a graph is formed: its simple form, its fingerprint, and which node stands for it."""
