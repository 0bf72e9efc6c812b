"""Decision of a study: designs ranked by one index, the verdict in one sentence, and its caveats."""
