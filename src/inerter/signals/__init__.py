"""Roads as random processes, and signals: road heights, displacements and forces as functions of time."""
