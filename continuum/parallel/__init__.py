"""One run of the continuum shared by several processes under MPI.

The cells are distributed along the pillar, or by the graph of a rock mass; every process advances
its own, and forces on shared degrees of freedom are summed at every step.
"""
