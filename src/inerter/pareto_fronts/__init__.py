"""Pareto fronts: the trade-off between several indices."""
