"""One joint that carries no tension and is rigid when closed, between two half-spaces of rock.

A wave sigma_I, compression positive, of particle velocity v_I = sigma_I / Z meets it at rest. Open,
the joint is two free faces: v_T = 0, v_R = v_I, and the gap changes at the rate -2 v_I. It opens
where sigma_I turns to tension and closes where the gap is back at zero; closed it passes all, v_T =
v_I, v_R = 0. So the gap is (2/Z) times the reflected Lindley recursion of the impulse,

    gap(t) = (2/Z) (max_{s <= t} I(s) - I(t)),   I(t) = integral of sigma_I,

the joint is closed where I is at its maximum so far, and sigma_T is the rate of that maximum."""

import numpy as np

from jointwave.cases.histories import LoadHistory


def gap(load: LoadHistory, times: np.ndarray, impedance: float) -> np.ndarray:
    """Return the gap (m) at closely spaced times (s) from before the load on; Z in Pa s/m."""
    impulse = load.impulse(times)
    return 2 / impedance * (np.maximum.accumulate(impulse) - impulse)


def transmitted(load: LoadHistory, times: np.ndarray) -> np.ndarray:
    """Return sigma_T (Pa) at closely spaced times (s) from before the load on."""
    impulse = load.impulse(times)
    closed = impulse >= np.maximum.accumulate(impulse)
    return np.where(closed, np.maximum(load.value(times), 0.0), 0.0)
