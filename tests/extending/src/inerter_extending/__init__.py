"""Rows that inerter does not have, one file each."""
