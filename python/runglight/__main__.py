"""`python -m runglight` is the command `runglight`."""

import sys

from runglight.cli import main

if __name__ == "__main__":
    sys.exit(main())
