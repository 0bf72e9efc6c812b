"""Kinds of statements of an identification, with their sentences."""
