"""Published results, recomputed: one folder a paper, with its tables, tasks, claims, figures and words."""
