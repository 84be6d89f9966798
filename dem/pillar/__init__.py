"""Pillars as rigid blocks: from their scene to the model, and from its samples to results."""
