"""Motions with real friction and backlash: two integrators, and the trajectories that they leave."""
