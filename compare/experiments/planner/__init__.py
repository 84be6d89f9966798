"""The cheapest configuration that meets a misfit."""
