"""H2 and H-infinity norms and frequency responses of linear systems; they know matrices, never a car."""
