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
# # Rock of your own, as UFL forms
#
# The continuum is a dolfinx model, and its rock is two bilinear UFL forms: mass and stiffness. A
# script can replace those of `[rock]` by its own. Two examples follow: rock that stiffens with
# depth, and transversely isotropic rock. Each is checked against a known wave speed.
#
# The scene is a column 60 m high with periodic left and right sides, so that a pressure on its top
# sends a plane wave down. Its quiet base absorbs the wave. `[rock]` is still needed for settings
# that the script does not give, such as the default element size.

# %%
import matplotlib.pyplot as plt
import numpy as np
import ufl

import jointwave as jw
from jointwave import continuum

DENSITY, PERIOD, DEPTHS = 2600.0, 2e-3, [5.0, 20.0, 35.0, 50.0]  # kg/m3, s, m
column = {
    "title": "A wave down a column of rock",
    "domain": {"size": [1.0, 60.0]},  # m
    "rock": {"density": DENSITY, "intact_modulus": 2.5e10, "intact_poisson": 0.25},
    "loads": [
        {"kind": "pressure", "side": "top", "shape": "ricker", "period": PERIOD, "amplitude": 1e6}
    ],
    "boundaries": {"left": "periodic", "right": "periodic", "bottom": "quiet", "top": "free"},
    "time": {"duration": 0.04},  # s
    "record": {"points": [[0.5, 60.0 - depth] for depth in DEPTHS], "interval": 2e-5},
    "numerics": {"continuum": {"size": 0.75, "order": 4}},
}
scene = jw.load(column)


def delay(one, other, times):
    """Return the delay of a waveform relative to another by cross-correlation, s."""
    step = float(times[1] - times[0])
    found = np.correlate(one, other, "full")
    k = int(found.argmax())
    before, at, after = found[k - 1 : k + 2]
    return step * (k - len(times) + 1 + (before - after) / (before - 2 * at + after) / 2)


# %% [markdown]
# ## Rock that stiffens with depth
#
# The modulus $M = \lambda + 2\mu$ grows as $(1 + d/h)^2$ with the depth $d$, and the P speed
# $c = \sqrt{M/\varrho}$ as $c_0 (1 + d/h)$. The rock is a function of the scene and of the dolfinx
# space of displacements. `isotropic` takes numbers or UFL expressions, here of
# `SpatialCoordinate`:

# %%
SPEED, HEIGHT = 2500.0, 30.0  # m/s at the top; m, over which it doubles


def stiffening(scene, space):
    """Return rock of Poisson's ratio 0.25, for which lambda = mu = M / 3."""
    depth = 60.0 - ufl.SpatialCoordinate(space.mesh)[1]
    modulus = DENSITY * SPEED**2 * (1 + depth / HEIGHT) ** 2
    return continuum.isotropic(space, DENSITY, modulus / 3, modulus / 3)


result = continuum.simulate(scene, rock=stiffening)
result.velocity.sel(axis="y").plot.line(x="time")
plt.show()

# %% [markdown]
# The wave arrives after the integral of $1/c$ over the depth, $(h/c_0) \ln(1 + d/h)$:

# %%
waves = result.velocity.sel(axis="y").values
for depth, wave in zip(DEPTHS[1:], waves[1:], strict=True):
    travelled = HEIGHT / SPEED * np.log((HEIGHT + depth) / (HEIGHT + DEPTHS[0]))
    found = delay(wave, waves[0], result.time.values)
    print(
        f"from {DEPTHS[0]:g} m to {depth:g} m: {1e3 * found:.3f} ms, integral {1e3 * travelled:.3f}"
    )
    assert abs(found / travelled - 1) < 1e-3

# %% [markdown]
# ## Transversely isotropic rock
#
# Bedded rock is softer across the bedding than along it. The stiffness tensor $C_{ijkl}$ is given
# in the axes of the bedding, which dips at 30 degrees, and rotated. Plane waves down the column
# have the speeds and directions of Christoffel's equation,
# $C_{ijkl}\, n_j n_l\, g_k = \varrho c^2 g_i$:

# %%
ALONG, ACROSS, BETWEEN, SHEAR = 40e9, 20e9, 8e9, 9e9  # C11, C33, C13, C44, Pa
c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
turn = np.array([[c, -s], [s, c]])
of_bedding = np.zeros((2, 2, 2, 2))
of_bedding[0, 0, 0, 0], of_bedding[1, 1, 1, 1] = ALONG, ACROSS
of_bedding[0, 0, 1, 1] = of_bedding[1, 1, 0, 0] = BETWEEN
for i, j, k, m in [(0, 1, 0, 1), (0, 1, 1, 0), (1, 0, 0, 1), (1, 0, 1, 0)]:
    of_bedding[i, j, k, m] = SHEAR
moduli = np.einsum("ia,jb,kc,md,abcd->ijkm", turn, turn, turn, turn, of_bedding)


def bedded(scene, space):
    """Return transversely isotropic rock."""
    return continuum.anisotropic(space, DENSITY, moduli)


values, shapes = np.linalg.eigh(moduli[:, 1, :, 1])
speeds = np.sqrt(values / DENSITY)
print(f"quasi-S {speeds[0]:.0f} m/s, quasi-P {speeds[1]:.0f} m/s")

# %% [markdown]
# The vertical pressure sends both waves down. Each wave is the motion along its own polarisation:

# %%
result = continuum.simulate(scene, rock=bedded)
motion = result.velocity.transpose("point", "time", "axis").values @ shapes
for name, speed, waves in zip(
    ("quasi-S", "quasi-P"), speeds, np.moveaxis(motion, 2, 0), strict=True
):
    found = (DEPTHS[1] - DEPTHS[0]) / delay(waves[1], waves[0], result.time.values)
    print(f"{name}: {found:.1f} m/s, Christoffel {speed:.1f}")
    assert abs(found / speed - 1) < 1e-3
    plt.plot(1e3 * result.time, waves[1], label=name)
plt.xlabel("time (ms)")
plt.ylabel(f"velocity at {DEPTHS[1]:g} m (m/s)")
plt.legend()
plt.show()

# %% [markdown]
# Stress at receivers follows from the same forms, with the mean moduli of each cell. So do the
# dashpots of quiet sides: the square root of $\varrho\, C_{ijkl} n_j n_l$ absorbs both plane waves
# at normal incidence:

# %%
largest = abs(result.velocity).max()
left = abs(result.velocity.sel(time=slice(0.036, None))).max()
print(f"left of the waves once they have gone: {float(left / largest):.1e}")
assert left < 1e-3 * largest

# %% [markdown]
# ## Explicit forms
#
# `isotropic` and `anisotropic` return `Forms(mass, stiffness, damping)`. Any stiffness bilinear in
# the strains of the trial and test functions is allowed, here isotropic rock:

# %%
from ufl import dx, grad, inner, sym, tr


def by_hand(scene, space):
    """Return isotropic rock with lambda = mu = 1e10 Pa."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    strain = sym(grad(u))
    stress = 1e10 * (tr(strain) * ufl.Identity(2) + 2 * strain)
    return continuum.Forms(DENSITY * inner(u, v) * dx, inner(stress, sym(grad(v))) * dx)


result = continuum.simulate(scene, rock=by_hand)
stress = result.stress.sel(stress_component="yy")[1]
wave = -np.sqrt(DENSITY * 3e10) * result.velocity.sel(axis="y")[1]  # stress of a downward wave
assert abs(stress - wave).max() < 5e-3 * abs(wave).max()
plt.plot(1e3 * result.time, 1e-6 * stress, label="stress")
plt.plot(1e3 * result.time, 1e-6 * wave, "--", label="impedance times velocity")
plt.xlabel("time (ms)")
plt.ylabel(f"vertical stress at {DEPTHS[1]:g} m (MPa)")
plt.legend()
plt.show()
