"""How the reproduction is shown: its tables, its text, its figures and its page."""
