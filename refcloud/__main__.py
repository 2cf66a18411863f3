"""Let ``python -m refcloud`` do what the command ``refcloud`` does."""

import sys

from refcloud.cli import main

if __name__ == "__main__":
    sys.exit(main())
