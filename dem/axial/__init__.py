"""One row of blocks in axial motion: one degree of freedom per block."""
