"""What all kinds of files share: elements, layouts and signals in TOML, what is wrong with them, and result folders."""
