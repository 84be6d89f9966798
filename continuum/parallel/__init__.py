"""One run of the continuum shared by several processes under MPI.

The cells are dealt out along the pillar, or by the graph of a rock mass; every process steps its
own, and what several cells of different processes push on is summed up at every step.
"""
