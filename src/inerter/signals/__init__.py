"""Roads and, later, forces and sampled signals."""
