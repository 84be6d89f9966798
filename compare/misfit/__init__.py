"""Distances between waveforms: metrics, pairs of solutions, external data."""
