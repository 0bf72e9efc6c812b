"""H2 and H-infinity norms and frequency responses of linear systems, from matrices alone."""
