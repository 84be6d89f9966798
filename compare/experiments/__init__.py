"""Experiments over many runs: studies, sweeps, plans, fits, ablation, robustness, cost."""

#: Studies without a file.
IN_CODE = ("stability", "oblique-joint", "parallel-joints")
