"""Designs in the formats of other programs: one file for each kind, one description of the linear model for all."""
