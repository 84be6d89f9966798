"""Undamped homogenised bar by images (d'Alembert; Graff, Wave Motion in Elastic Solids, 1975).

The end stress f enters with amplitude g and travels to and fro in the bar, multiplied at each end
by its reflection coefficient of stress: R = -1 free, +1 fixed, 0 quiet or matched.

    sigma = g sum_k (R_start R_end)^k [f(t - (2kL + y)/c) + R_end f(t - (2(k+1)L - y)/c)]
    v = (g/Z) sum_k (R_start R_end)^k [f(t - (2kL + y)/c) - R_end f(t - (2(k+1)L - y)/c)]

g = 1 at a free start; at a quiet or matched start half of the stress is taken by the dashpot Z, g =
1/2. Displacement is v with the load's impulse instead of f.

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
from jointwave.compare.exact.conditions import holds
from jointwave.compare.solvers.record import Answer, Form, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

Signal = Callable[[np.ndarray], np.ndarray]
MOST_TRIPS = 1_000_000  # round trips through the bar

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
    waves["stress"] = waves["stress"] + calibrate(scene).prestress
    return dataset(scene, SOLVER.name, times, waves)


class Front(NamedTuple):
    """Undamped rock at the loaded end, in which kinks and jumps of the load travel to and fro.

    length, speed, impedance : m, m/s, Pa s/m. start, end : reflection coefficients of stress.
    enters : share of the wave that enters. on_end : share of this part in the motion at its end.
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
        """Return stress, velocity, displacement [receivers, n] of a load that is zero for t < 0."""
        there, back = self._travelling(load.value, np.array(stress_y), times)
        found = [there + back]
        for signal in (load.value, load.impulse):
            there, back = self._travelling(signal, np.array(velocity_y), times)
            found.append((there - back) / self.impedance)
        return found

    def _travelling(self, signal: Signal, places: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return the waves away from the start and back to it [2, places, times]."""
        shares, both = self.shares(places), np.zeros((2, len(places), len(times)))
        ahead = shares > 0
        y = places[ahead, None]
        for k in range(floor(self.speed * times[-1] / (2 * self.length)) + 1):
            trips = (self.start * self.end) ** k
            if trips:
                both[0, ahead] += trips * signal(times - (2 * k * self.length + y) / self.speed)
            if trips * self.end:
                late = (2 * (k + 1) * self.length - y) / self.speed
                both[1, ahead] += trips * self.end * signal(times - late)
        return self.enters * shares[:, None] * both


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
