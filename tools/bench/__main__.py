"""All benchmarks, as ratios and costs of one run on this machine.

usage: python tools/bench [PART ...], of cutting, startup, kernels, plane and continuum
"""

import sys

import cutting
import deformable
import kernels
import plane
import startup

PARTS = {
    "cutting": cutting.main,
    "startup": startup.main,
    "kernels": kernels.main,
    "plane": plane.main,
    "continuum": deformable.main,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
