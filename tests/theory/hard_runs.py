"""Runs of hard cases on any engine by any scheme, and the largest error that each may have.

Near a critical step, beside stiff joints or at a resonance an unstable scheme may be wrong but
finite. Every such run is therefore compared with the error that a stable one can have."""

from functools import cached_property
from math import pi, sqrt

import numpy as np
import pytest

from jointwave import cases
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.pulse import shortest_period
from jointwave.compare.engines import ENGINES, applies, solve, solvers
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import find
from jointwave.continuum.mesh.size import elements_along

SHORT = "hard/short-pillar"
JOINT = 8.748e9  # Pa/m, K'_n of an ordinary joint of the short pillar
EPS = 2.2e-16
ROUND_OFF = 2e-15  # of a step: some operations of eps each
#: Root mean squares of f^3 and f^5 over the spectrum of a Ricker wavelet, f^2 exp(-f^2) with its
#: peak at f = 1: sqrt of Gamma(11/2) / Gamma(5/2) / 2^3 and Gamma(15/2) / Gamma(5/2) / 2^5.
CUBES, FIFTHS = 2.22, 6.64
#: Relative error of a frequency over (omega dt)^2. Leapfrog: sin(W dt/2) = omega dt / 2. Trapezoid:
#: tan(W dt/2) = omega dt/2; generalised alpha lags a little more.
ERROR = {"leapfrog": 1 / 24, "fourth-order": 1 / 24, "explicit": 1 / 24, "implicit": 1 / 6}
REFEREE = 5e-6  # of the exact bars: their inversion takes the mean load of steps, 6e-7 at the peak
SCHEMES = [(name, scheme) for name, one in ENGINES.items() for scheme in one.schemes]
EXPLICIT = [one for one in SCHEMES if one[1] != "implicit"]
BLOCKS = [one for one in SCHEMES if one[0] == "dem"]
ROCK = [one for one in SCHEMES if one[0] != "dem"]
JOINTED = [one for one in SCHEMES if one[0] != "continuum-equivalent"]
#: Of linear rock in both models and by both schemes, two runs stand for four.
CROSSED = [("continuum-jointed", "implicit"), ("continuum-equivalent", "explicit")]


def marked(schemes, slow=CROSSED):
    """Return engines with schemes as parameters of a test, some of them slow."""
    marks = {True: [pytest.mark.slow], False: []}
    return [pytest.param(*one, id=" ".join(one), marks=marks[one in slow]) for one in schemes]


class HardRun:
    """A scene with changes on one engine by one scheme. Changes have dotted keys; `step` and
    `allow` are the step_fraction and allow_unstable of the engine."""

    def __init__(self, engine, scheme, changes=None, scene=SHORT, variant=""):
        self.engine, self.scheme, self.where = ENGINES[engine], scheme, (find(scene), variant)
        self.changes = dict(changes or {})

    def read(self, **more):
        """Return the scene with more keys (dots written __) changed."""
        part = f"numerics.{self.engine.engine}"
        keys = {key.replace("__", "."): value for key, value in more.items()}
        # Rigid blocks in the plane have leapfrog only.
        keys = {f"{part}.scheme": self.scheme} | self.changes | keys
        keys = {k: v for k, v in keys.items() if v != "leapfrog"}
        for short, name in (("step", "step_fraction"), ("allow", "allow_unstable")):
            if short in keys:
                keys[f"{part}.{name}"] = keys.pop(short)
        return cases.load_variant(*self.where, keys)

    def run(self, **more):
        """Return the result of the scene with more keys changed."""
        return solve(self.engine.name, self.read(**more))

    @cached_property
    def scene(self):
        return self.read()

    @cached_property
    def result(self):
        return self.run()

    @cached_property
    def properties(self):
        return calibrate(self.scene)

    @cached_property
    def critical(self):
        """The critical step of explicit steps, s."""
        return self.engine.prepare(self.read(step=0.5)).critical

    @property
    def dt(self):
        return float(self.result.attrs["dt"])

    @property
    def steps(self):
        return float(self.result.attrs["steps"])

    @property
    def duration(self):
        return self.scene.time.duration

    @property
    def peak(self):
        """The angular frequency of the peak of the load's spectrum, rad/s."""
        return 2 * pi / (shortest_period(self.scene.pulses) or self.duration)

    def referee(self):
        """Return the first exact solution of the model that the engine discretises, None without;
        and the misfit from it."""
        for one in solvers():
            own = one.exact and one.discretised and one.rock is self.engine.rock
            if own and applies(one.name, self.scene):
                return one.name, misfit(self.result, solve(one.name, self.scene))
        return None, np.nan

    def phase_error(self):
        """Return the misfit due to the steps of a second-order scheme at the end of a run. A
        relative error e of the frequency omega is the phase e omega t at time t, and a wave that is
        wrong by a small phase has a relative error of the same size: C (omega dt)^2 omega t,
        averaged over the spectrum."""
        return ERROR[self.scheme] * (self.peak * self.dt) ** 2 * CUBES * self.peak * self.duration

    def element_error(self):
        """Return the misfit due to quadratic GLL elements at the end of a run; none for blocks.
        Their phase speed is wrong by (omega tau)^4 / 2880, tau the time through an element
        (Ainsworth & Wajid, SIAM J. Numer. Anal. 47, 2009). The traction of a joint that is recorded
        is known to the round-off of its gap, eps K u, with u no more than 2 p t / Z under a stress
        p; ten operations of this are allowed."""
        if self.engine.has_rigid_blocks:
            return 0.0
        p, t = self.properties, self.duration
        phase = (self.peak * self.time_of_element) ** 4 / 2880 * FIFTHS * self.peak * t
        own = p.own_stiffness if self.engine.model == "jointed" else p.stiffness
        read = own[np.rint(np.array(self.scene.record.stress) / p.spacing).astype(int) - 1]
        return phase + 10 * EPS * float(read.max()) * 2 * t / p.impedance

    def corner_error(self):
        """Return the misfit from the two kinks of a sine that starts and ends; none for a wavelet.
        A change of slope s has the spectrum s / omega^2; what of it is beyond the w of `lost_after`
        is lost: by Parseval s^2 (4 + 1/5) / (3 pi w^3), against cycles T / 2 of the sine."""
        load = self.scene.load
        if load.shape != "sine":
            return 0.0
        square = 2 * self.peak**2 * 4.2 * self.lost_after() ** 3 / (3 * pi)
        return sqrt(square / ((load.cycles or 1) * load.period / 2))

    def lost_after(self):
        """Return 1 / w (s): frequencies beyond w have lost their phase by the end of a run. That of
        the steps is C (w dt)^2 w t = 1, that of elements (w tau)^4 w t / 2880 = 1."""
        lost = (ERROR[self.scheme] * self.dt**2 * self.duration) ** (1 / 3)
        if self.engine.has_rigid_blocks:
            return lost
        return lost + (self.time_of_element**4 * self.duration / 2880) ** (1 / 5)

    @property
    def time_of_element(self):
        """The travel time of a wave through an element of the rock, s."""
        p, jointed = self.properties, self.engine.model == "jointed"
        modulus = p.intact_modulus if jointed else p.modulus
        count = elements_along(self.scene, str(self.engine.model))[0]
        return p.spacing / count / sqrt((modulus or p.modulus) / p.density)

    def allowed(self):
        """Return the misfit that steps, elements, corners and the referee may make."""
        return self.phase_error() + self.element_error() + self.corner_error() + REFEREE
