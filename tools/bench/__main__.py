"""All benchmarks of the rigid blocks, as ratios and costs of one run on this machine.

usage: python tools/bench [startup] [kernels] [effects] [memory]
"""

import sys

import effects
import kernels
import memory
import startup

PARTS = {
    "startup": startup.main,
    "kernels": kernels.main,
    "memory": memory.main,
    "effects": effects.main,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
