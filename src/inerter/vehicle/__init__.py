"""Mechanisms, and the cars that are mechanisms."""
