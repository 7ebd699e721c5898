"""Reads files one after the other in this process and says what came of each, for test_fuzz.

python fuzzing.py FILE ...  prints two lines a file: its name before, the outcome after it: "read",
"refused" or "wrong: " and why.  Each has two seconds (five where another process reads it) and,
beside what is loaded, a gigabyte.
"""

import resource
import signal
import sys
import warnings

import numpy as np

from inetlib import io
from inetlib.io import exchange

SECONDS, MEMORY = 2, 2**30
exchange.PATIENCE = 5  # of that other process


def outcome(path):
    """What came of reading one file, in a word or two."""
    try:
        V, F = io.read(path)
    except ValueError as error:
        good = str(error).startswith(path) and "\n" not in str(error) and len(str(error)) < 500
        return "refused" if good else f"wrong: says {str(error)[:200]!r}"
    except BaseException as error:
        return f"wrong: {type(error).__name__}: {str(error)[:200]}"
    corners = np.concatenate([np.asarray(face) for face in F]) if len(F) else np.array([-1])
    whole = V.ndim == 2 and V.shape[1] == 3 and V.dtype == float and np.isfinite(V).all()
    named = corners.min() >= 0 and corners.max() < len(V) and corners.dtype == np.int64
    return "read" if whole and named else "wrong: not finite, or a face of vertices not there"


def late(number, frame):
    raise TimeoutError("too long")


if __name__ == "__main__":
    warnings.simplefilter("error")
    signal.signal(signal.SIGALRM, late)
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY + resource.getrusage(0).ru_maxrss * 1024,) * 2)
    for path in sys.argv[1:]:
        print(path, flush=True)
        elsewhere = path.endswith((".vtp", ".3dm"))
        signal.setitimer(signal.ITIMER_REAL, exchange.PATIENCE + 2 if elsewhere else SECONDS)
        found = outcome(path)
        signal.setitimer(signal.ITIMER_REAL, 0)
        print(found, flush=True)
