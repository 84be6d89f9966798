"""Undamped homogenised bar by images (d'Alembert; Graff, Wave Motion in Elastic Solids, 1975).

The end stress f enters with amplitude g and travels back and forth in the bar, multiplied at each
end by that end's reflection coefficient of stress: R = -1 free, +1 fixed, 0 quiet or matched.

    sigma = g sum_k (R_start R_end)^k [f(t - (2kL + y)/c) + R_end f(t - (2(k+1)L - y)/c)]
    v = (g/Z) sum_k (R_start R_end)^k [f(t - (2kL + y)/c) - R_end f(t - (2(k+1)L - y)/c)]

g = 1 at a free start; behind a dashpot Z (quiet or matched start) half the stress goes into the
dashpot, g = 1/2. Displacement is v with the load's impulse in place of f.

Valid for any load; no dashpots, no soft layers, every joint carries tension.
"""

from collections.abc import Callable
from math import floor

import numpy as np
import xarray as xr

from jointwave.cases.histories import LoadHistory
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.conditions import holds, static_stress
from jointwave.compare.solvers.record import Answer, Form, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

MOST_TRIPS = 1_000_000  # through the bar and back

#: Reflection coefficient of stress at an end of the bar.
REFLECTION = {"free": -1.0, "fixed": 1.0, "quiet": 0.0, "matched": 0.0}
#: Share of the end stress that enters the bar.
ENTERS = {"free": 1.0, "quiet": 0.5, "matched": 0.5}


def applies(scene: Scene) -> Answer:
    """Return whether images are the exact solution of the scene's homogenised bar."""
    trips = calibrate(scene).bar_speed * scene.time.duration / (2 * scene.pillar.length)
    many = f"the wave crosses the bar more than {MOST_TRIPS:,} times"
    return holds(scene, ("prestress", "thick layers"), (trips > MOST_TRIPS, many))


def entering(scene: Scene) -> LoadHistory:
    """Return the stress wave that the end stress of a scene sends into the bar, Pa."""
    share = ENTERS[scene.ends.start]
    load = scene.load.model_copy(update={"amplitude": share * scene.load.amplitude})
    return load_history(scene.model_copy(update={"load": load}))


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's homogenised bar."""
    p, load, times = calibrate(scene), entering(scene), sample_times(scene)
    ends = scene.ends.start, scene.ends.end

    def waves(signal: Callable, places: list[float]) -> tuple[np.ndarray, np.ndarray]:
        start, end = (REFLECTION[kind] for kind in ends)
        return images(signal, places, times, scene.pillar.length, p.bar_speed, start, end)

    there, back = waves(load.value, scene.record.stress)
    stress = there + back
    there, back = waves(load.value, scene.record.velocity)
    velocity = (there - back) / p.impedance
    there, back = waves(load.impulse, scene.record.velocity)
    displacement = (there - back) / p.impedance
    return dataset(scene, SOLVER.name, times, stress + static_stress(scene), velocity, displacement)


def images(
    signal: Callable[[np.ndarray], np.ndarray],
    places: list[float] | np.ndarray,
    times: np.ndarray,
    length: float,
    speed: float,
    start: float = -1.0,
    end: float = -1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the waves travelling away from the start and back to it, each [places, times].

    Stress is their sum, particle velocity their difference over the impedance.

    Parameters
    ----------
    signal : the wave entering at y = 0, a function of time (s), zero before t = 0.
    places, times : m and s.
    length, speed : of the bar, m and m/s.
    start, end : reflection coefficients of stress at the two ends.
    """
    y, t = np.asarray(places, dtype=float)[:, None], np.asarray(times, dtype=float)
    there, back = np.zeros((2, len(y), len(t)))
    for k in range(floor(speed * t[-1] / (2 * length)) + 1):
        trips = (start * end) ** k
        if trips:
            there += trips * signal(t - (2 * k * length + y) / speed)
        if trips * end:
            back += trips * end * signal(t - (2 * (k + 1) * length - y) / speed)
    return there, back


SOLVER = Solver(
    name="images",
    rock=Rock.HOMOGENISED,
    form=Form.CLOSED,
    label="homogenised bar, images",
    line=thin("#00a26d", 5, (13.5, 15.5)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {
            "continuum-equivalent": "the same, from d'Alembert's images",
            "series": "truncation of the paper's series",
        }
    },
)
