"""`python -m compare` is the command `jointwave`."""

from compare.cli.start import main

if __name__ == "__main__":
    main()
