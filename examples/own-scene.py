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
# # A scene of your own
#
# A scene is a set of tables: a TOML file, which the command `jointwave` reads, or a dictionary.

# %%
import jointwave as jw

tables = {
    "title": "A weak layer in a short pillar",
    "pillar": {"length": 20.0, "side": 0.5, "block": 0.5},  # m
    "rock": {
        "density": 2400.0,  # kg/m3
        "p_speed": 2200.0,  # m/s
        "s_speed": 800.0,  # m/s
        "intact_modulus": 8.64e10,  # Pa; without it there is no rock between the joints
    },
    "soft_layers": [{"y": 8.0, "spacing_stiffness": 4.375e8}],  # m, Pa
    "load": {
        "shape": "ricker",
        "amplitude": 5.0e5,  # Pa
        "quantity": "incident-stress",  # of the incident wave
        "period": 0.01,  # s
    },
    "ends": {"start": "matched", "end": "matched"},
    "time": {"duration": 0.05},  # s
    "record": {"stress": [4.0, 12.0], "fields": 2.5e-4},  # m, s
}
scene = jw.load(tables)

# %% [markdown]
# A scene that contradicts itself is refused; the message says what is allowed:

# %%
try:
    jw.load(tables | {"pillar": {"length": 20.0, "side": 0.5, "block": 0.3}})
except jw.SceneError as error:
    print(error)
else:
    raise AssertionError("a block that does not divide the pillar was taken")

# %% [markdown]
# ## Which solvers apply
#
# All solvers, with the reason for those that do not apply:

# %%
for name, reason in jw.solvers(scene).items():
    print(f"{name:22} {reason or 'holds'}")

# %% [markdown]
# ## The wave in space and time
#
# `record.fields` saves snapshots of the whole pillar. Every rigid block is one cell, so that the
# stress over time and y is a plain array:

# %%
import matplotlib.pyplot as plt
import numpy as np

result = jw.simulate(scene)
centres = scene.pillar.block * (np.arange(scene.pillar.block_count) + 0.5)
wave = result.field_stress.assign_coords(cell=("cell", centres, {"long_name": "y", "units": "m"}))
wave.plot(x="cell", y="field_time", cmap="RdBu_r", robust=True)
plt.axvline(8.0, color="black", linewidth=0.8, linestyle=":")
plt.show()

# %% [markdown]
# The layer at 8 m reflects part of the pulse and transmits mainly low frequencies. The reflected
# wave is the stress in front of the layer minus the incident pulse. No energy is lost:

# %%
without = jw.simulate(jw.load(tables | {"soft_layers": []}))
reflected = (result.stress - without.stress).sel(stress_y=4.0)
passed, incident = result.stress.sel(stress_y=12.0), without.stress.sel(stress_y=12.0)
for label, wave in {"incident": incident, "passed": passed, "reflected": reflected}.items():
    plt.plot(1e3 * wave.time, 1e-6 * wave, label=label)
plt.xlabel("time (ms)")
plt.ylabel("axial stress (MPa)")
plt.legend()
plt.show()


def energy(wave):
    """Return the energy of a wave that travels in one direction, except for a factor."""
    return float((wave**2).sum())


shares = energy(reflected) / energy(incident), energy(passed) / energy(incident)
print(f"reflected {shares[0]:.1%}, passed {shares[1]:.1%}")
assert abs(sum(shares) - 1) < 0.01

# %% [markdown]
# ## Test it against a bound
#
# An `[expect]` table makes a scene file a test, run by `pytest my-scenes/`. From Python:

# %%
distance = jw.misfit(result, jw.simulate(scene, "lattice"))
print(f"rigid blocks from their exact motion: {distance:.1e}")
assert distance < 0.005

# %% [markdown]
# Both, with the continuum:

# %%
result.jw.plot(jw.simulate(scene, "lattice"), jw.simulate(scene, "continuum-jointed"))
