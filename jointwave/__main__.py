"""`python -m jointwave` is the command `jointwave`."""

from jointwave.compare.cli.program import main

__all__ = ["main"]

if __name__ == "__main__":
    main()
