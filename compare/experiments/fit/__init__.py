"""Keys of a scene fitted to measured waveforms by least squares."""
