"""Studies over many runs: each is one table, one diagram, and points that are saved."""

from pathlib import Path

SHIPPED = Path(__file__).parent / "shipped"
#: Studies that have no file there.
IN_CODE = ("stability", "oblique-joint", "parallel-joints")
