"""Configurations of an identification: how records are read, what is fitted, and what comes of it."""
