"""Running pieces of work, and what is kept of them, whatever they compute."""
