"""python -m inetlib: the same as `inet`."""

import sys

from inetlib.start import main

if __name__ == "__main__":
    sys.exit(main())
