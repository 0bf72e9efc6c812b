"""Plots of one call each: axes go in and come back, or are made.

Every function draws on the axes that it is given; without, on new ones of the style of the package. In a notebook the
figure is shown by its axes, `ax.figure`; it is saved by `ax.figure.savefig("name.svg")`.
"""
