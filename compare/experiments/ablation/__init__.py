"""Ablation: the cost of every effect, and its influence on the result."""
