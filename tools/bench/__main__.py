"""All benchmarks, as ratios and costs of one run on this machine.

usage: python tools/bench [startup] [kernels] [plane] [guards] [continuum] [effects] [memory]
"""

import sys

import deformable
import effects
import guards
import kernels
import memory
import plane
import startup

PARTS = {
    "startup": startup.main,
    "kernels": kernels.main,
    "plane": plane.main,
    "guards": guards.main,
    "continuum": deformable.main,
    "memory": memory.main,
    "effects": effects.main,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
