"""How every kernel is compiled: one set of options, one cache that follows the sources."""

import hashlib
import os
from pathlib import Path

import numba

PACKAGES = ("joints", "dem", "continuum")


def cache_directory(root: Path) -> Path:
    """Return a cache directory keyed by the sources of the kernels' packages below `root`.

    A compiled caller does not notice that a function in another file has changed; a new
    directory for each state of the sources does.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    for package in PACKAGES:
        for source in sorted((root / package).glob("*.py")):
            digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or Path(
        os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "jointwave", "numba"
    )
    return Path(base, digest.hexdigest()[:16])


numba.config.CACHE_DIR = str(cache_directory(Path(__file__).resolve().parent.parent))

#: Compiles a kernel: cached on disk, IEEE arithmetic (fastmath would break bit-identity).
jitted = numba.njit(cache=True, fastmath=False, error_model="numpy")
