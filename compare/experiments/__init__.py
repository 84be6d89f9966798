"""Experiments over many runs: studies, sweeps, plans, fits, ablation, robustness, cost."""

#: Studies that are no file.
IN_CODE = ("stability", "oblique-joint", "parallel-joints")
