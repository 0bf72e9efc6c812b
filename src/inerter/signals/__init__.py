"""Random road models, and signals: road heights, displacements and forces as functions of time."""
