"""A plane shear wave at a joint under rate-and-state friction, by Runge-Kutta of order 8.

Under the pressure n, the joint carries s while its faces slide at V in the state theta (Dieterich
1979; Ruina 1983; Rice & Ben-Zion 1996):

    V = 2 V_0 sinh(s / (a n)) e^(-psi / a),   psi = mu_0 + b ln(V_0 theta / D_c),
    theta' = 1 - |V| theta / D_c.

Between half-spaces of impedance Z under the incident stress sigma_I, with the joint's additional
compliance 1/K,

    (Z / 2) (s' / K + V) = sigma_I - s.

For 1/K = 0 this is an algebraic equation for s, monotone and convex for s > 0, solved by Newton's
method from above. The slip u = s / K + S, S' = V, gives the transmitted impulse: that of sigma_I
minus Z u / 2.
"""

from math import asinh, copysign, exp, log
from typing import NamedTuple

import numpy as np

from jointwave.cases.histories import LoadHistory
from jointwave.compare.exact.joint.trajectory import SHORTEST, Trajectory, edges_of, peak_of

SPANS = 500  # least number of steps over the whole time
TOLERANCES = 1e-11, 1e-9  # for the integration and its twin
LARGE = 300.0  # bound on ln of a rate or age, exceeded only in trial steps that are too long
MOST, SETTLED = 100, 1e-15  # Newton's method: most corrections, relative size of the last one


class RateJoint(NamedTuple):
    """A joint under the pressure n, Pa: mu_0, a and b, D_c (m), V_0 (m/s), theta_0 (s), and its
    additional compliance 1/K, m/Pa."""

    pressure: float
    friction: float
    direct: float
    evolution: float
    distance: float
    rate: float
    state: float
    compliance: float = 0.0

    def offset(self, log_state: float) -> float:
        """Return ln V_0 - psi / a for ln theta."""
        aged = log(self.rate / self.distance) + log_state
        return log(self.rate) - (self.friction + self.evolution * aged) / self.direct

    def slides(self, stress: float, log_state: float) -> float:
        """Return V (m/s) for s (Pa) and ln theta."""
        x, offset = stress / (self.direct * self.pressure), self.offset(log_state)
        return _exp(offset + x) - _exp(offset - x)

    def carries(self, incident: float, log_state: float, impedance: float) -> float:
        """Return s (Pa) of a joint with 1/K = 0 under sigma_I (Pa)."""
        if not incident:
            return 0.0
        a, z, most = self.direct * self.pressure, impedance / 2, abs(incident)
        offset = self.offset(log_state)
        fast = log(most) - log(2 * z) - offset
        s = min(most, a * (asinh(exp(fast)) if fast < LARGE else fast + log(2)))
        for _ in range(MOST):
            up, down = _exp(offset + s / a), _exp(offset - s / a)
            less = (s + z * (up - down) - most) / (1 + z / a * (up + down))
            s = max(s - less, 0.0)
            if abs(less) <= SETTLED * most:
                break
        return copysign(s, incident)


def _exp(x: float) -> float:
    """Return e^x, bounded so as to stay finite."""
    return exp(min(x, LARGE))


class RateStateWave:
    """sigma_T (Pa) and its impulse (Pa s) at any time up to `end` (s), under the incident `load`.

    impedance : Z, Pa s/m. tolerance : relative, of a step. rest : stationary contact before t = 0,
    s.
    """

    def __init__(
        self,
        joint: RateJoint,
        impedance: float,
        load: LoadHistory,
        end: float,
        tolerance: float,
        rest: float = 0.0,
    ) -> None:
        self.joint, self.impedance, self.load = joint, impedance, load
        first, peak = load.breaks[0], peak_of(load, end)
        span = max(end - first, SHORTEST) / SPANS
        slip = max(joint.distance, peak * span / impedance)
        start = [0.0, log(joint.state + rest + first), 0.0]
        scale = np.array([slip, 1.0, peak])
        self.state = Trajectory(self._rate, start, edges_of(load, end), tolerance, scale, span)

    def _rate(self, t: float, now: np.ndarray) -> list[float]:
        """Return the rates of S, ln theta and s (0 where 1/K = 0)."""
        joint, incident, loads = self.joint, float(self.load.value(np.asarray(t))), 0.0
        _, log_state, stress = now.tolist()
        if joint.compliance == 0:
            stress = joint.carries(incident, log_state, self.impedance)
        slides = joint.slides(stress, log_state)  # sigma_I - s would suffer from cancellation
        if joint.compliance:
            loads = (2 * (incident - stress) / self.impedance - slides) / joint.compliance
        return [slides, _exp(-log_state) - abs(slides) / joint.distance, loads]

    def __call__(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return sigma_T (Pa) and its impulse (Pa s) at times (s)."""
        joint, (slide, log_state, stress) = self.joint, self.state(times)
        if joint.compliance == 0:
            both = zip(self.load.value(times).flat, log_state.flat, strict=True)
            carried = [joint.carries(*each, self.impedance) for each in both]
            stress = np.reshape(carried, times.shape)
        slip = joint.compliance * stress + slide
        return stress, self.load.impulse(times) - self.impedance * slip / 2
