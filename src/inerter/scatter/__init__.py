"""Designs whose values scatter: what that does to an index, and which design bears it best."""
