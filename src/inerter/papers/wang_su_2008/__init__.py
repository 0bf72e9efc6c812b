"""Wang and Su (2008), Impact of inerter nonlinearities on vehicle suspension control, recomputed.

The paper is a row (`paper`), its tables and designs are data (`source`), and each part of it is a list of calls of the
library: `linear` (norms, Figure 11), `rows` (simulated rows of Tables 1 to 3), `curves` (Figures 13 and 14), `claims`,
and `beyond` (what the paper did not do). `reproduce` puts them together, and `report` shows them. Nothing here depends
on a printed number but the comparison with it.
"""
