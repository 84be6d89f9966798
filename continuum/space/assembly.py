"""The rock of a mesh and the jumps across its joints, whole or shared by several processes."""

from jointwave.continuum.mesh.description import Mesh
from jointwave.continuum.space.body import Body, build_body
from jointwave.continuum.space.interface import Jumps, jumps


def body_and_jumps(comm, mesh: Mesh, *asked, **named) -> tuple[Body, Jumps | None]:
    """Return the rock of a mesh and the jumps across its joints (None without), or this process's
    share of them; what is asked is as for `build_body`."""
    if comm is not None:
        from jointwave.continuum.parallel.body import share_of

        return share_of(comm, mesh, *asked, **named)
    body = build_body(mesh, *asked, **named)
    return body, jumps(body) if mesh.joints.joint.size else None
