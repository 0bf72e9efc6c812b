"""Methods: evaluation of an index for a design, by norms, by linearisation, or by simulation."""
