"""Results: waveforms, energies and snapshots as xarray datasets and NetCDF files."""
