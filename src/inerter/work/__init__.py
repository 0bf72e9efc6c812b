"""Execution of work in chunks, with journals of results, independent of their content."""
