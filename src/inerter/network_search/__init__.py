"""Search of the best network among all that a number of springs, dampers and inerters can form."""
