"""Files read and written by this package, one subpackage per kind, independent of the computations."""
