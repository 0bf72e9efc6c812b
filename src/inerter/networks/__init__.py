"""Elements, the algebra of `|` and `-`, its expressions in strings, and the linearisation of networks."""
