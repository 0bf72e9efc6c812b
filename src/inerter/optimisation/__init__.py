"""Optimisation of the free values of a design."""
