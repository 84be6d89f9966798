"""Time integration schemes on linear systems, in closed form."""
