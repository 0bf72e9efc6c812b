"""Report of the reproduction: tables, text, figures and page."""
