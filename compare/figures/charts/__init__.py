"""Charts of a scene's results: waveforms, spectra, space-time diagrams, energy."""
