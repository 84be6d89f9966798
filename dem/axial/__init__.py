"""One row of blocks in motion along its axis: one freedom a block."""
