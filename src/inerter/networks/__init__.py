"""Elements, the algebra of `|` and `-`, the same in strings, and what a network is to linear analysis."""
