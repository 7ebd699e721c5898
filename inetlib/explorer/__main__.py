"""python -m inetlib.explorer [FILE]: the same as `inet explore`."""

import sys

from inetlib.start import main

if __name__ == "__main__":
    sys.exit(main(["explore", *sys.argv[1:]]))
