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
from typing import NamedTuple

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
    p, record, times, ends = calibrate(scene), scene.record, sample_times(scene), scene.ends
    reflects = REFLECTION[ends.start], REFLECTION[ends.end]
    bar = Front(scene.pillar.length, p.bar_speed, p.impedance, *reflects)
    found = bar.waves(entering(scene), times, record.stress, record.velocity)
    waves = dict(zip(("stress", "velocity", "displacement"), found, strict=True))
    waves["stress"] = waves["stress"] + static_stress(scene)
    return dataset(scene, SOLVER.name, times, waves)


class Front(NamedTuple):
    """Undamped rock from the loaded end on, which reflects kinks and jumps at its two ends.

    length, speed, impedance : m, m/s, Pa s/m. start, end : reflection coefficients of stress.
    enters : the fraction of the wave that enters. on_end : its share in the motion at its end.
    """

    length: float
    speed: float
    impedance: float
    start: float
    end: float
    enters: float = 1.0
    on_end: float = 1.0

    def shares(self, places: np.ndarray) -> np.ndarray:
        """Return this part's share in each place's motion: 1 inside, 0 behind it."""
        off = (places - self.length) / self.length
        return np.where(np.abs(off) < 1e-9, self.on_end, np.where(off < 0, 1.0, 0.0))

    def waves(
        self, load: LoadHistory, times: np.ndarray, stress_y: list[float], velocity_y: list[float]
    ) -> list[np.ndarray]:
        """Return its stress, velocity and displacement [receivers, n]."""
        found, signals = list[np.ndarray](), (load.value, load.value, load.impulse)
        for signal, places in zip(signals, (stress_y, velocity_y, velocity_y), strict=True):
            y, out = np.array(places), np.zeros((len(places), len(times)))
            sign, scale = (-1, self.impedance) if found else (1, 1.0)
            shares = self.shares(y)
            ahead = shares > 0
            bar = self.length, self.speed, self.start, self.end
            there, back = images(signal, y[ahead], times, *bar)
            out[ahead] = shares[ahead, None] * self.enters / scale * (there + sign * back)
            found.append(out)
        return found


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
