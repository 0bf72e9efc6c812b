"""Wang and Su (2008) as a row: what it is called, its parts, its claims and its figures."""

from __future__ import annotations

from inerter.papers.paper import Paper

_HERE = "inerter.papers.wang_su_2008"
PRINTED = ("rig", "linear", "table1", "table2", "table3", "figure12", "figure13", "figure14", "claims")
PARTS = (*PRINTED, "methods", "optima", "budgets")  # the last ones are not in the paper
FIGURE_8, FIGURE_9, FIGURE_10, FIGURE_11, FIGURE_12, FIGURE_13, FIGURE_14 = (f"figure-{n}" for n in range(8, 15))
METHODS = "methods"
NETWORKS = "networks"
CLAIMS = {
    1: "Elastic effect only: the benefit in J1 shrinks, more so with the softer setting.",
    2: "Elastic effect only: J3 of S3 is slightly better than with an ideal inerter below k = 120 kN/m, worse above.",
    3: (
        "Elastic effect only: the benefit in J5 shrinks, more so with the softer setting; elastic S3 is worse than S1 "
        "near k = 55 kN/m."
    ),
    4: (
        "Friction only, Method 1: J1 and J3 degrade, more with 20 N than with 10 N; for k up to about 15 kN/m J1 is "
        "worse than S1's; at large k it is still better."
    ),
    5: "Friction only, Method 1: at small k J3 of S2 and S3 is worse than S1's, and so is J5 of S2.",
    6: (
        "Friction only, Method 2: 10 N is negligible for J1 and J3; 100 N costs J3 about 1 % (S2) and 2.5 % (S3) of "
        "the improvement."
    ),
    7: "Friction only, Method 2: J5 becomes worse for S2 and slightly better for S3.",
    8: (
        "Both effects, Method 1, J1: at large k friction alone is better than elasticity alone, below k = 50 kN/m (S2) "
        "and 150 kN/m (S3) the contrary; both together are always the worst."
    ),
    9: (
        "Both effects, Method 1, J3, best first: S2 with soft k: ideal, elastic, friction, both; S2 above 140 kN/m: "
        "ideal, friction, elastic, both; S3 below 30 kN/m: elastic, both, ideal, friction; S3 above 230 kN/m: ideal, "
        "friction, elastic, both."
    ),
    10: (
        "Both effects, Method 1, J5: both together are the worst; S3 is influenced more by elasticity than by "
        "friction, S2 by elasticity at large k and by friction below 140 kN/m."
    ),
    11: "Both effects, Method 2, quarter car: J1 degrades by 2 to 3 %, J3 by about 0.5 %.",
    12: (
        "Both effects, half car: by Method 2 J1 degrades by 2 to 3 %, J3 by less than 1 %, J5 by up to 6.5 % (S3); by "
        "Method 1 J5 by about 8 % for S2 and S3."
    ),
    13: "The suspension with a nonlinear inerter is still better than the traditional one, especially at large k.",
}
FIGURES = {
    FIGURE_8: (
        "Figure 8 recomputed, on a virtual rig: friction without the flywheel, a cosine of 0.1 Hz and 1 mm. The force "
        "is a square wave of 10 N, rounded where the shaft winds up."
    ),
    FIGURE_9: (
        "Figure 9 recomputed, on a virtual rig: a cosine of 3 Hz and 1 mm, and the force of the identified model; the "
        "third of five seconds."
    ),
    FIGURE_10: (
        "Figure 10 recomputed, on a virtual rig: from displacement to force, by a multisine of 0.1 mm r.m.s. from 0.5 "
        "to 20 Hz that nothing was fitted to. The identified model on the same displacement, its linear part, and its "
        "inertance alone, all as the load cell reads them."
    ),
    FIGURE_11: (
        "Figure 11 recomputed: optimal indices of the quarter car over the static stiffness, and their improvement "
        "over S1, with an ideal inerter and with an elastic one in its hard (2000 kN/m, 6400 N s/m) and soft setting "
        "(1000 kN/m, 3200 N s/m)."
    ),
    FIGURE_12: "Figure 12 recomputed: one period of a road of eq. (17), seed 0.",
    FIGURE_13: (
        "Figure 13 recomputed: the optimal linear designs with friction in the inerter, by the approximated linear "
        "model (Method 1). Bands: two standard errors."
    ),
    FIGURE_14: (
        "Figure 14 recomputed: ideal inerter, the soft elastic one, friction of 10 N, and both, by the approximated "
        "linear model (Method 1). Bands: two standard errors."
    ),
    METHODS: (
        "Increase of J1 and J3 by friction, printed designs of Table 1, by three methods; bars: two standard errors. "
        "Method 1 drives the car with white noise of height, which moves the inerter far less than the road does: "
        "friction then weighs about ten times more."
    ),
    NETWORKS: ("The layouts, and the device: spring k, damper c, inerter b; shaft kₛ and cₛ, backlash ε, friction f."),
}

PAPER = Paper(
    name="wang-su-2008",
    title="Wang and Su (2008), Impact of inerter nonlinearities on vehicle suspension control",
    parts=PARTS,
    claims=CLAIMS,
    figures=FIGURES,
    examples=("--only linear", "--only rig    Figures 8 to 10, on a virtual rig", "--only table1 --only figure14"),
    recompute=f"{_HERE}.reproduce:reproduce",
    write=f"{_HERE}.report.page:write_reproduction",
    data=f"{_HERE}.report.data:tables",
    text=f"{_HERE}.report.text:reproduction_text",
)
