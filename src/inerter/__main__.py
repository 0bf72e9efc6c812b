"""`python -m inerter`: the command line."""

from inerter.cli.start import main

if __name__ == "__main__":
    main()
