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
# The free pillar of Guo & Li (2002): a hundred blocks, a pulse of 10 ms, both ends free. Both
# engines simulate it, exact solutions say how far from the truth each of them is.

# %%
import jointwave as jw

scene = jw.load("guo-li-2002/fig-03", changes={"time.duration": 0.06})
print(scene.title, "-", scene.pillar.block_count, "blocks")

# %% [markdown]
# ## Simulate
#
# Each engine returns an `xarray.Dataset`, the same for both: stress in Pa on the sections that the
# scene records, positive in compression, and the energies.

# %%
blocks = jw.simulate(scene, "dem")
rock = jw.simulate(scene, "continuum-jointed")
blocks

# %% [markdown]
# The waveforms on every section lie on top of each other, but not quite:

# %%
blocks.jw.plot(rock)

# %% [markdown]
# ## Who is right?
#
# `lattice` is the exact motion of the rigid blocks, `jointed-bar` that of elastic rock with all
# joints. The distance of an engine to the solution of its own model is its *numerical* error; the
# distance between the models is the *modelling* error, which no smaller step removes.

# %%
lattice, bar = jw.simulate(scene, "lattice"), jw.simulate(scene, "jointed-bar")
print(f"blocks, numerical error  {jw.misfit(blocks, lattice):.2%}")
print(f"rock, numerical error    {jw.misfit(rock, bar):.2%}")
print(f"blocks, modelling error  {jw.misfit(lattice, bar):.2%}")
assert jw.misfit(blocks, lattice) < 0.005 < jw.misfit(lattice, bar)

# %% [markdown]
# `jw.compare` does all of that at once, for every pair and every receiver:

# %%
for row in jw.compare(scene).rows:
    if row.quantity == "stress":
        pair, found = row.pair, row.distance
        print(f"{pair.one:20} {pair.other:20} {pair.kind:16} {found.misfit:8.3%}")

# %% [markdown]
# ## Where the energy is
#
# Work that the load has put in is kinetic or elastic: nothing else is in this scene.

# %%
import matplotlib.pyplot as plt

stored = blocks.energy.sel(term=["kinetic", "elastic"]).sum("term")
balance = stored - blocks.energy.sel(term="work")
assert float(abs(balance).max()) < 1e-9 * float(blocks.energy.max())
blocks.energy.plot.line(x="time")
plt.show()
