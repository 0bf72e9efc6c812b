"""Measured roads: profiles, their roughness, and what they are to an analysis."""
