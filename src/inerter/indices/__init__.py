"""Performance indices of a suspension, and the excitations on which they are defined."""
