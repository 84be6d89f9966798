"""The wave seen: both engines' pillars as an animation, and in three dimensions."""
