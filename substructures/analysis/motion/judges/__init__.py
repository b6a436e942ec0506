"""What must hold along a computed motion: first integrals, the balance of energy, lengths of quaternions."""
