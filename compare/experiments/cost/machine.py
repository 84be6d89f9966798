"""The machine that seconds depend on: processor, cores, versions."""

import os
import platform
from pathlib import Path

import numpy as np


def machine() -> dict[str, str]:
    """Return what seconds depend on."""
    import numba

    return {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def measured_on() -> str:
    """Return the machine in words."""
    about = machine()
    return f"{about['processor']}, {about['cores']} cores, numba {about['numba']}"


def processor() -> str:
    """Return the processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
