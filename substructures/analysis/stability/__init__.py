"""States of rest and what happens near them: equilibria, linearisation, vibrations, root loci."""
