"""All benchmarks, as ratios and costs of one run on this machine.

usage: python tools/bench [PART ...], of cutting, startup, kernels, blocks and continuum
"""

import sys

import blocks
import cutting
import deformable
import kernels
import startup

PARTS = {
    "cutting": cutting.main,
    "startup": startup.main,
    "kernels": kernels.main,
    "blocks": blocks.main,
    "continuum": deformable.main,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
