"""Study files: vehicles, layouts, indices, methods and swept values, read from TOML and checked."""
