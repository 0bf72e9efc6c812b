"""Matrices: linear systems, and the one place where mechanics becomes matrices."""
