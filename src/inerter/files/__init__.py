"""What this package reads and writes as files, apart from what is in them."""
