"""Parts common to all kinds of files: elements, layouts and signals in TOML, problems of entries, result folders."""
