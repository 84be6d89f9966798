"""The distance between waveforms: metrics, pairs of solutions, external data."""
