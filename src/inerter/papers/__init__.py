"""Published results as data and checks, one module a paper."""
