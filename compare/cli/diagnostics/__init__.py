"""Diagnostics of the installation, `jointwave doctor`."""
