"""dolfinx spaces on open meshes, rock as UFL forms, and the jump operator of joints."""
