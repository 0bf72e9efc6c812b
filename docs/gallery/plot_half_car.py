"""
Two axles, one road
===================

The rear wheel meets the road a little later than the front one. At some frequencies that cancels most of the heave, at
others most of the pitch (wheelbase filtering).
"""

import inerter as it

k = {"front": it.Spring(40e3, "kf"), "rear": it.Spring(45e3, "kr")}


def car(front, rear):
    return it.HalfCar(
        sprung_mass=650,
        pitch_inertia=1000,
        unsprung_mass_front=45,
        unsprung_mass_rear=45,
        tyre_stiffness_front=190e3,
        tyre_stiffness_rear=190e3,
        distance_front=1.2,
        distance_rear=1.5,
        front=k["front"] | front,
        rear=k["rear"] | rear,
    )


comfort = it.RideComfort(it.Road(roughness=1e-6, speed=25))
c = [it.Damper(it.free(100, 20e3, name)) for name in ("cf", "cr")]
b = [it.Inerter(it.free(1, 2000, name)) for name in ("bf", "br")]
best = {
    "S1": it.optimise(car(*c), comfort, it.Norm(), seed=0).design,
    "S3": it.optimise(car(c[0] - b[0], c[1] - b[1]), comfort, it.Norm(), seed=0).design,
}
for name, design in best.items():
    print(name, it.evaluate(design, comfort, it.Norm()).value)
gain, phase = it.plot_bode(best, comfort)  # from the road under both axles, the rear one delayed
gain.set_xlim(0.3, 30)
phase.set(xlim=(0.3, 30), ylim=(-1500, 200))
