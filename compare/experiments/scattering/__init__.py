"""What solvers make of reflection and transmission at one joint, against the angle."""
