"""What is read of a body: points, joints, sections, snapshots."""
