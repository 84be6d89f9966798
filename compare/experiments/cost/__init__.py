"""The cost model: time and memory of steps, runs and experiments."""
