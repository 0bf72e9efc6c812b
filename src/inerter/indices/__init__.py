"""What is asked of a suspension."""
