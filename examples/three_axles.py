"""A vehicle that is not in the box: a rigid body on three axles, each meeting the road a little later."""

import inerter as it

speed, levers = 22.0, {"front": 2.1, "middle": -1.2, "rear": -2.4}  # axles ahead of the centre of mass [m]
strut = it.Spring(250e3) | it.Damper(it.free(1e3, 1e5, name="c")) - it.Inerter(it.free(1, 5000, name="b"))

truck = it.Mechanism(
    coordinates=(
        it.Coordinate("body", 9000.0),  # [kg]
        it.Coordinate("pitch", 18000.0, angle=True),  # [kg m^2]
        *(it.Coordinate(f"{axle}_wheel", 350.0) for axle in levers),
    ),
    struts=tuple(
        it.Strut(axle, strut, upper={"body": 1.0, "pitch": lever}, lower={f"{axle}_wheel": 1.0})
        for axle, lever in levers.items()
    ),
    tyres=tuple(it.Tyre(f"{axle}_tyre", it.Spring(900e3), {f"{axle}_wheel": 1.0}, f"{axle}_road") for axle in levers),
    roads=tuple(it.RoadInput(f"{axle}_road", distance=levers["front"] - lever) for axle, lever in levers.items()),
    forces=(it.Force("load", {"body": 1.0}),),
    measures=it.PerformanceOutputs(
        comfort=(it.OutputWeight("body_acceleration"), it.OutputWeight("pitch_acceleration", 2.1)),
        tyre_load=tuple(it.OutputWeight(f"{axle}_tyre_load") for axle in levers),
        load_input="load",
        load_output="body_displacement",
    ),
)
road = it.Road(roughness=2e-6, speed=speed)
best = it.optimise(truck, it.RideComfort(road), it.Norm(), seed=0)
grip = it.evaluate(best.design, it.TyreLoad(road), it.Norm())

print(f"{best.value:.3f} {best.unit} with c = {best.parameters['c']:.0f} N s/m, b = {best.parameters['b']:.0f} kg")
print(f"dynamic tyre load, three axles together: {grip.value:.0f} {grip.unit}")
print(f"states: {', '.join(it.state_space(best.design).states)}")

assert best.status.ok
assert grip.status.ok
