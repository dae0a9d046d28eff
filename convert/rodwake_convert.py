"""Convert a film of particles to another format: rodwake_convert.py IN -o OUT; --help names the options."""

import sys

from rodwake_convert.command import main

if __name__ == "__main__":
    sys.exit(main())
