"""The commands of `jointwave`."""
