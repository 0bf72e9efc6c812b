"""Tasks on the best designs of a study, one module each: break-even values, Pareto fronts, tolerances."""
