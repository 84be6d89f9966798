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
# # Joint stiffness against the transmission formula
#
# The transmission coefficient of a joint of stiffness $K$ between half-spaces of impedance $Z$, for
# a harmonic wave, is (Schoenberg 1980; Pyrak-Nolte, Myer & Cook 1990)
#
# $$ |T| = \frac{1}{\sqrt{1 + (\omega Z / 2K)^2}} . $$
#
# A pulse contains many frequencies: the ratio of the spectra with and without the joint is $|T|$ at
# all of them. The results of both engines for four stiffnesses must then lie on one curve over
# $K / \omega Z$.

# %%
import matplotlib.pyplot as plt
import numpy as np

import jointwave as jw

ENGINES = {"dem": "rigid blocks", "continuum-equivalent": "homogenised rock"}
PERIOD = 0.02  # s, one over the pulse's peak frequency
tables = {
    "title": "One joint between half-spaces",
    "pillar": {"length": 40.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
    "load": {
        "shape": "ricker",
        "amplitude": 1.0e6,  # Pa
        "quantity": "incident-stress",  # of the incident wave
        "period": PERIOD,  # s
    },
    "ends": {"start": "matched", "end": "matched"},
    "time": {"duration": 0.2},
    "record": {"stress": [30.0]},
}
plain = jw.load(tables)
rock = jw.properties(plain)
print(f"impedance Z              {rock.impedance:.4g} Pa s/m")
print(f"K'_n of an ordinary joint {rock.regular_stiffness:.4g} Pa/m")

# %% [markdown]
# ## The sweep
#
# The homogenised rock already contains an ordinary joint at the position of the soft one, so $K$ is
# the stiffness of the added compliance, $1/K = 1/K'_n(\text{soft}) - 1/K'_n$. The layer is chosen
# to add just $1/K$.


# %%
def with_joint(stiffness):
    """Return the scene with a joint at 20 m that adds the compliance 1/stiffness (m/Pa)."""
    softer = 1 / (1 / stiffness + 1 / rock.regular_stiffness)
    layer = {"y": 20.0, "spacing_stiffness": plain.pillar.block * softer}
    return jw.load(tables | {"soft_layers": [layer]})


def spectrum(engine, scene):
    """Return angular frequencies (rad/s) and the spectrum of the stress behind the joint."""
    found = jw.spectra(jw.simulate(scene, engine), "stress")[0]
    return 2 * np.pi * found.frequency.values, found.values


peak = 2 * np.pi / PERIOD * rock.impedance
stiffnesses = peak * np.array([0.2, 0.5, 1.0, 2.0])  # Pa/m
measured = {}
for engine in ENGINES:
    omega, incident = spectrum(engine, plain)
    heard = abs(incident) > 0.1 * abs(incident).max()
    for stiffness in stiffnesses:
        passed = spectrum(engine, with_joint(stiffness))[1]
        measured[engine, stiffness] = omega[heard], abs(passed / incident)[heard]

# %% [markdown]
# ## Comparison with the formula
#
# The largest difference from the formula at any frequency, for each stiffness:

# %%
print("K (Pa/m)     rigid blocks  homogenised rock")
worst = 0.0
for stiffness in stiffnesses:
    row = []
    for engine in ENGINES:
        omega, found = measured[engine, stiffness]
        formula = 1 / np.sqrt(1 + (omega * rock.impedance / (2 * stiffness)) ** 2)
        row.append(abs(found - formula).max())
    worst = max(worst, *row)
    print(f"{stiffness:.3e}    {row[0]:<12.4f}  {row[1]:.4f}")
assert worst < 0.02

# %% [markdown]
# All results lie on one curve:

# %%
figure, ax = plt.subplots(layout="constrained")
kappa = np.geomspace(0.05, 10, 200)
ax.semilogx(kappa, 1 / np.sqrt(1 + 1 / (2 * kappa) ** 2), color="black", label="formula")
looks = ("o", "#56b4e9"), ("x", "#009e73")
for engine, (marker, colour) in zip(ENGINES, looks, strict=True):
    for stiffness in stiffnesses:
        omega, found = measured[engine, stiffness]
        label = ENGINES[engine] if stiffness == stiffnesses[0] else None
        at = stiffness / (omega * rock.impedance)
        ax.plot(at, found, marker, color=colour, fillstyle="none", markersize=5, label=label)
ax.set(xlabel=r"$K / \omega Z$", ylabel="|T|")
ax.legend()
plt.show()
