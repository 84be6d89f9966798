"""dolfinx spaces on meshes cut along joints, rock as UFL forms, and the jump operator of joints."""
