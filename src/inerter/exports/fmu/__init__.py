"""Functional mock-up units (FMI 2.0 and 3.0) for co-simulation, in C99 without Python."""
