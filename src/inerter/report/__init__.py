"""Reports of results: a page to read and print, and tables for the terminal."""
