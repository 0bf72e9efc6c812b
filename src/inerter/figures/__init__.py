"""Figures of results: every function takes results and axes, computes nothing, and returns the axes."""
