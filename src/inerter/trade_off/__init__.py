"""Trade-offs: the best designs of several indices at once."""
