"""Energy account: work of roads, forces and branches along a piece of the motion."""

from __future__ import annotations

from inerter.kernels.arrays import Account, Run
from inerter.kernels.decorators import part
from inerter.kernels.flow import over_columns, polynomial


@part(borrowing=True, inside=True)
def take_account(run: Run, account: Account, count: int, s: float, d: float) -> None:
    """Energy through roads, forces and branches during the first part s of a piece, by Gauss's rule."""
    sizes, room, energy = run.mechanics.sizes, run.room, run.motion.energy
    n, nr, nu, branches = sizes.states, sizes.roads, sizes.inputs, account.branch_road.shape[0]
    maps, first = run.modes.maps[run.motion.place[0].mode], run.mechanics.rows.output + sizes.squares
    nf, x, u = nu - 3 * nr, room.guess, room.given
    for g in range(account.nodes.shape[0]):
        at = s * account.nodes[g]
        weight = s * d * account.weights[g]
        for i in range(n):
            x[i] = polynomial(room.series, count, i, at)
        for j in range(nu):
            u[j] = polynomial(room.inputs, 4, j, at)
        for b in range(branches):
            force = over_columns(maps[first + branches + b], x, u, n, nu)
            energy[nr + nf + b] += weight * force * over_columns(maps[first + b], x, u, n, nu)
            for c in range(nr):
                energy[c] += weight * force * account.branch_road[b, c] * u[nr + c]
        for f in range(nf):
            energy[nr + f] += weight * u[3 * nr + f] * over_columns(maps[first + 2 * branches + f], x, u, n, nu)
