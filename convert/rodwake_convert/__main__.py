"""Convert a film of particles to another format: python3 rodwake_convert IN -o OUT, with the path of this folder; --help names the options."""

import sys
from pathlib import Path

if not __package__:  # run by the name of the folder, which is then first on the path in place of the one that holds it
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from rodwake_convert.command import main  # noqa: E402

if __name__ == "__main__":
    sys.exit(main())
