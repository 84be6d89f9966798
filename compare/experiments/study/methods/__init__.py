"""Alternative methods, timed beside the engines."""
