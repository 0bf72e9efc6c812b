"""The best strut of a quarter car for ride comfort, and what it is worth."""

import inerter as it

k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, name="c")), it.Inerter(it.free(1, 2000, name="b"))
car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=k | c - b)
usual = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=k | c)
road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)

best = it.optimise(car, comfort, it.Norm(), seed=0)
baseline = it.optimise(usual, comfort, it.Norm(), seed=0)
improvement = 100 * (1 - best.value / baseline.value)

print(f"{best.value:.4f} {best.unit} with c = {best.parameters['c']:.0f} N s/m and b = {best.parameters['b']:.1f} kg")
print(f"{improvement:.2f} % better than the best spring and damper ({baseline.value:.4f} {baseline.unit})")
print(f"its dynamic tyre load: {it.evaluate(best.design, grip, it.Norm()).value:.1f} N")
print(f"{best.n_converged} of {best.n_starts} searches found it; held back by bounds: {best.active_bounds or 'none'}")

assert abs(improvement - 18.74) < 0.01  # Wang and Su (2008), section 2.2
