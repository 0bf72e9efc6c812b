"""Passive synthesis: networks of springs, dampers and inerters with a given admittance."""
