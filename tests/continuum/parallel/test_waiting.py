"""The barrier for long waits, in real processes."""

import json

#: The last process comes late; prints for each how long it has waited, and the CPU time of that.
LATE = """
import json, time
from mpi4py import MPI
from numerics.waiting import arrive

world = MPI.COMM_WORLD
arrive(world)
began, used = time.monotonic(), time.process_time()
if world.rank == world.size - 1:
    time.sleep(0.5)
arrive(world)
found = world.gather((time.monotonic() - began, time.process_time() - used))
if world.rank == 0:
    print(json.dumps(found))
"""


def test_processes_sleep_until_the_last_one_has_arrived(under_mpi):
    """None goes on before it, or spins: MPI's own barrier takes all of the time."""
    found = json.loads(under_mpi(3, "-c", LATE).stdout)
    assert len(found) == 3
    for waited, used in found:
        assert waited > 0.49 and used < 0.2
