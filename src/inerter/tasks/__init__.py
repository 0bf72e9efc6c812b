"""What a study asks of its best designs besides their values, each in one file."""
