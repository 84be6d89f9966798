"""Experiments over many runs: studies, sweeps, plans, fits, ablation, robustness, cost."""
