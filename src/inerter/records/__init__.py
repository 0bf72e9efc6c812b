"""Measured records: reading them, judging them, preparing them, and their frequency response."""
