"""The best values of a design's free values."""
