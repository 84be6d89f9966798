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
# # Waves at joints, by angle
#
# A wave that meets a joint at an angle produces four waves: reflected P and S, and transmitted P
# and S. `jw.transmission` returns the ratios of their particle velocities to that of the incident
# wave, in closed form and from both engines.
#
# The shipped scene has one joint in rock, with $K_n \approx Z_p \omega$ and
# $K_s \approx Z_s \omega$.

# %%
import matplotlib.pyplot as plt
import numpy as np

import jointwave as jw

scene = jw.load("rock-mass/one-joint")
jw.transmission(scene, [0, 20, 40, 60]).to_dataframe().round(3)

# %% [markdown]
# ## Is it right?
#
# At normal incidence the formula for one joint is simple (Pyrak-Nolte, Myer & Cook 1990), with
# $\kappa = K_n / Z_p \omega$:
#
# $$ |T| = \frac{2 \kappa}{\sqrt{1 + 4 \kappa^2}} . $$
#
# At any angle the energy of the four waves must equal the incident energy. A wave of amplitude $A$
# carries $\rho c A^2 \cos\theta$ through the joint's plane.

# %%
density, p_speed, s_speed = 2600.0, np.sqrt(6e10 / 2600.0), np.sqrt(2e10 / 2600.0)
kappa = scene.joint_sets[0].normal_stiffness * 0.005 / (density * p_speed * 2 * np.pi)
normal = jw.transmission(scene, 0).squeeze()
print(f"|T| {normal.T_p:.4f}, by the formula {2 * kappa / np.sqrt(1 + 4 * kappa**2):.4f}")

angles = np.arange(0.0, 89.0)
curves = jw.transmission(scene, angles).squeeze("solver")
cos_p = np.cos(np.radians(angles))
cos_s = np.sqrt(1 - (s_speed / p_speed * np.sin(np.radians(angles))) ** 2)
energy = curves.R_p**2 + curves.T_p**2
energy += s_speed * cos_s / (p_speed * cos_p) * (curves.R_s**2 + curves.T_s**2)
print(f"energy that leaves, over that which comes: {energy.min():.12f} to {energy.max():.12f}")
assert abs(energy - 1).max() < 1e-9

# %% [markdown]
# ## The engines
#
# Each angle is a separate run: a pulse in a domain with this rock and joint. The amplitudes of the
# five waves are fitted to the motion at 8 points; `residual` is the part that they do not explain.

# %%
solvers = ["dem", "continuum-jointed"]
measured = jw.transmission(scene, [0, 30, 60], solvers)
off = abs(measured - curves.sel(angle=measured.angle)).drop_vars("residual")
for solver in solvers:
    residual = float(measured.residual.sel(solver=solver).max())
    worst = float(off.sel(solver=solver).to_array().max())
    print(f"{solver:18} at most {worst:.4f} from the closed form, residual {residual:.4f}")
assert off.sel(solver="continuum-jointed").to_array().max() < 1e-3

# %%
figure, ax = plt.subplots(layout="constrained")
for name, colour in {"R_p": "C0", "R_s": "C1", "T_p": "C2", "T_s": "C3"}.items():
    ax.plot(angles, curves[name], color=colour, label=f"$|{name}|$")
    for solver, marker in zip(solvers, "ox", strict=True):
        ax.plot(measured.angle, measured[name].sel(solver=solver), marker, color=colour)
ax.plot([], [], "ok", label="rigid blocks")
ax.plot([], [], "xk", label="jointed rock")
ax.set(xlabel="angle of the P wave from the joint's normal (degrees)", ylim=(-0.03, 1.3))
ax.set_ylabel("particle velocity over the incident wave's")
ax.legend(ncols=3, loc="upper center")
plt.show()
