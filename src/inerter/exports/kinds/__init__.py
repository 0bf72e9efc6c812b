"""Kinds of exports: each module states its own as `ExportKind`, and the registry finds them without being told."""
