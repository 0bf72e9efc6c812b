"""How a number is got."""
