"""All benchmarks, as ratios and costs of one run on this machine.

usage: python tools/bench [PART ...], of startup, kernels, plane and continuum
"""

import sys

import deformable
import kernels
import plane
import startup

PARTS = {
    "startup": startup.main,
    "kernels": kernels.main,
    "plane": plane.main,
    "continuum": deformable.main,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
