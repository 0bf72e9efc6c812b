"""Measured roads: profiles, their roughness and spectra, and their signals."""
