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
# # A first scene
#
# The free pillar of Guo & Li (2002) has a hundred blocks, both ends are free, and the pulse lasts
# 10 ms. Both engines simulate it; exact solutions give the error of each.

# %%
import jointwave as jw

scene = jw.load("guo-li-2002/fig-03", changes={"time.duration": 0.06})
print(scene.title, "-", scene.pillar.block_count, "blocks")

# %% [markdown]
# ## Simulate
#
# Both engines return an `xarray.Dataset` of the same form: stress in Pa, positive in compression,
# at the recorded sections, and the energies.

# %%
blocks = jw.simulate(scene, "dem")
rock = jw.simulate(scene, "continuum-jointed")
blocks

# %% [markdown]
# The waveforms at every section nearly coincide:

# %%
blocks.jw.plot(rock)

# %% [markdown]
# ## Which engine is right?
#
# `lattice` is the exact motion of the rigid blocks, `jointed-bar` that of elastic rock with all
# joints. The misfit of an engine from the exact solution of its own model is its *numerical* error;
# the misfit between the models is the *modelling* error, which a smaller step does not reduce.

# %%
lattice, bar = jw.simulate(scene, "lattice"), jw.simulate(scene, "jointed-bar")
print(f"blocks, numerical error  {jw.misfit(blocks, lattice):.2%}")
print(f"rock, numerical error    {jw.misfit(rock, bar):.2%}")
print(f"blocks, modelling error  {jw.misfit(lattice, bar):.2%}")
assert jw.misfit(blocks, lattice) < 0.005 < jw.misfit(lattice, bar)

# %% [markdown]
# `jw.compare` does all this in one call, for every pair and every receiver:

# %%
for row in jw.compare(scene).rows:
    if row.quantity == "stress":
        pair, found = row.pair, row.distance
        print(f"{pair.one:20} {pair.other:20} {pair.kind:16} {found.misfit:8.3%}")

# %% [markdown]
# ## The energy balance
#
# The work of the load becomes kinetic and elastic energy only: nothing in this scene dissipates it.

# %%
import matplotlib.pyplot as plt

stored = blocks.energy.sel(term=["kinetic", "elastic"]).sum("term")
balance = stored - blocks.energy.sel(term="work")
assert float(abs(balance).max()) < 1e-9 * float(blocks.energy.max())
blocks.energy.plot.line(x="time")
plt.show()
