"""
A motorcycle
============

Two wheels, a short wheelbase and a high pitch inertia: the front strut decides. Best values of both ends for
comfort at the rider.
"""

import inerter as it

comfort = it.RandomResponse({"rider_acceleration": 1.0}, it.Road(roughness=1e-6, speed=25))


def motorcycle(front, rear):
    return it.Mechanism(
        coordinates=(
            it.Coordinate("body", 200.0),
            it.Coordinate("pitch", 38.0, angle=True),
            it.Coordinate("front_wheel", 15.0),
            it.Coordinate("rear_wheel", 18.0),
        ),
        struts=(
            it.Strut("front", it.Spring(15e3) | front, upper={"body": 1.0, "pitch": 0.7}, lower={"front_wheel": 1.0}),
            it.Strut("rear", it.Spring(24e3) | rear, upper={"body": 1.0, "pitch": -0.7}, lower={"rear_wheel": 1.0}),
        ),
        tyres=(
            it.Tyre("front_tyre", it.Spring(180e3), {"front_wheel": 1.0}, "front_road"),
            it.Tyre("rear_tyre", it.Spring(180e3), {"rear_wheel": 1.0}, "rear_road"),
        ),
        roads=(it.RoadInput("front_road"), it.RoadInput("rear_road", distance=1.4)),
        points=(it.TrackedPoint("rider", {"body": 1.0, "pitch": -0.2}),),
    )


c = [it.Damper(it.free(50, 10e3, name)) for name in ("cf", "cr")]
b = [it.Inerter(it.free(1, 500, name)) for name in ("bf", "br")]
best = {
    "S1": it.optimise(motorcycle(*c), comfort, it.Norm(), seed=0).design,
    "S3": it.optimise(motorcycle(c[0] - b[0], c[1] - b[1]), comfort, it.Norm(), seed=0).design,
}
for name, design in best.items():
    print(name, it.evaluate(design, comfort, it.Norm()).value)
gain, phase = it.plot_bode(best, ("front_road", "rider_acceleration"))
