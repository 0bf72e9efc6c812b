"""Tolerance analysis: distribution of an index under tolerances of a design, and robust optimisation."""
