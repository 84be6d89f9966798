# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Calibrating a joint from a measured waveform
#
# A waveform was measured behind a soft joint, with noise. How stiff is the joint, and how
# accurately is that known? A run of the rigid-block engine takes milliseconds, so least squares can
# call it many times.
#
# Two numbers are unknown: the stiffness and the strength of the source. The measurement here is
# computed from known values, so that the answer can be checked.

# %%
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

import jointwave as jw

INTERVAL = 1.0e-4  # s
tables = {
    "title": "A soft joint, heard behind it",
    "pillar": {"length": 20.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10},
    "load": {
        "shape": "ricker",
        "amplitude": 5.0e5,  # Pa
        "quantity": "incident-stress",  # of the incident wave
        "period": 0.01,  # s
    },
    "ends": {"start": "matched", "end": "matched"},
    "time": {"duration": 0.04},
    "record": {"stress": [14.0], "interval": INTERVAL},
}
STIFFNESS, STRENGTH, NOISE = 4.0e8, 1.3, 0.02e6  # Pa (S K_n), factor of the amplitude, Pa


def scene(stiffness):
    """Return the scene with a joint of this spacing stiffness (Pa) at 8 m."""
    layer = {"y": 8.0, "spacing_stiffness": float(stiffness)}
    return jw.load(tables | {"soft_layers": [layer]})


def waveform(parameters):
    """Return the stress behind the joint [time], Pa, for (log10 of the stiffness, strength)."""
    exponent, strength = parameters
    return strength * jw.simulate(scene(10.0**exponent)).stress.values[0]


def measure(seed):
    """Return the waveform of the true joint with random noise [time], Pa."""
    exact = waveform((np.log10(STIFFNESS), STRENGTH))
    return exact + np.random.default_rng(seed).normal(scale=NOISE, size=exact.size)


# %% [markdown]
# ## The fit and its interval
#
# Near the best fit the waveform is almost linear in the parameters. With the Jacobian $J$ at the
# best fit and the variance of the residuals $s^2 = r^T r / (n - p)$, the covariance of the
# parameters is $s^2 (J^T J)^{-1}$, and Student's $t$ with $n - p$ degrees of freedom gives the
# interval (Bates & Watts, *Nonlinear Regression Analysis and Its Applications*, 1988).


# %%
class Fit(NamedTuple):
    """Best parameters [2], and half widths of their intervals [2]."""

    best: np.ndarray
    reach: np.ndarray


def fit(measured, confidence=0.95, start=(9.0, 1.0)):
    """Return the parameters that best fit a waveform [time], with their intervals."""
    scale = np.abs(measured).max()  # residuals of the order of one suit the optimiser
    found = least_squares(lambda x: (waveform(x) - measured) / scale, start, diff_step=1e-4)
    freedom = measured.size - found.x.size
    covariance = 2 * found.cost / freedom * np.linalg.inv(found.jac.T @ found.jac)
    quantile = student.ppf((1 + confidence) / 2, freedom)
    return Fit(found.x, quantile * np.sqrt(np.diag(covariance)))


measured = measure(seed=2002)
found = fit(measured)
low, high = 10 ** (found.best[0] - found.reach[0]), 10 ** (found.best[0] + found.reach[0])
print(f"stiffness {10 ** found.best[0]:.4g} Pa, 95 % within {low:.4g} to {high:.4g}")
print(f"strength  {found.best[1]:.4f} +- {found.reach[1]:.4f}")
print(f"in truth  {STIFFNESS:.4g} Pa and {STRENGTH}")
assert abs(found.best[0] - np.log10(STIFFNESS)) < 3 * found.reach[0]

# %%
times = 1e3 * INTERVAL * np.arange(measured.size)
figure, (waves, rest) = plt.subplots(2, sharex=True, layout="constrained")
waves.plot(times, 1e-6 * measured, ".", color="grey", markersize=3, label="measured")
waves.plot(times, 1e-6 * waveform((9.0, 1.0)), ":", color="black", label="first guess")
waves.plot(times, 1e-6 * waveform(found.best), label="fitted")
waves.set(ylabel="stress (MPa)")
waves.legend()
rest.plot(times, 1e-6 * (measured - waveform(found.best)), color="grey")
rest.set(xlabel="time (ms)", ylabel="measured less fitted (MPa)")
plt.show()

# %% [markdown]
# ## Is the interval right?
#
# In repeated measurements the true stiffness must lie inside the interval in about 95 of 100 cases:


# %%
def is_inside(seed):
    """Return whether the interval of a measurement contains the true stiffness."""
    one = fit(measure(seed))
    return bool(abs(one.best[0] - np.log10(STIFFNESS)) <= one.reach[0])


inside = [is_inside(seed) for seed in range(20)]
print(f"{sum(inside)} of {len(inside)} intervals contain the true stiffness")
assert sum(inside) >= 14  # fewer happen once in 30,000 times, if the intervals are right

# %% [markdown]
# ## What the interval does not include
#
# Noise is not the only error. For the same joint in *deformable* rock, measured without noise, the
# fit gives another stiffness. The interval says how accurate the number is if the model is right;
# the difference between the engines shows the error of the model.

# %%
rock = STRENGTH * jw.simulate(scene(STIFFNESS), "jointed-bar").stress.values[0]
other = fit(rock)
print(f"heard through deformable rock: {10 ** (other.best[0]) / STIFFNESS - 1:+.2%}")
assert abs(10 ** other.best[0] / STIFFNESS - 1) < 0.05

# %% [markdown]
# The residual is tiny: a good fit does not reveal that the model is wrong.

# %%
figure, ax = plt.subplots(layout="constrained")
ax.plot(times, 1e-6 * rock, color="black", label="deformable rock")
ax.plot(times, 1e-6 * (rock - waveform(other.best)), label="less the fitted blocks")
ax.set(xlabel="time (ms)", ylabel="stress (MPa)")
ax.legend()
plt.show()
