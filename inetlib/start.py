"""The program `inet` as a process of its own: Ctrl-C ends it with one sentence, at any moment.

A KeyboardInterrupt is lost, or becomes another error, when it comes while a module is loaded,
in the callback of a library or in a destructor.  Here the signal raises nothing: it clears up
and ends the process.  Nothing is imported before it is watched for.
"""

import os
import signal
import sys

STOPPED = 130
_last = []  # functions to call before the end


def main(arguments=None):
    """Run `inet`: the exit code.

    Paper: Sec. 6 (command line; beyond the paper).
    """
    given = sys.argv[1:] if arguments is None else arguments
    watch("inet", "" if given[:1] in (["figures"], ["explore"]) else ", nothing was written")
    from .cli import main as run

    code = run(given)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done, Python only cleans up
    return code


def watch(program, words=""):
    """From now on Ctrl-C says "PROGRAM: stopped" and ends this process with code 130.

    words: added to the sentence as long as no file was written.

    Paper: Sec. 6 (command line; beyond the paper).
    """

    def stop(number, frame):
        signal.signal(number, signal.SIG_IGN)
        files = sys.modules.get("inetlib.files")
        wrote = files is not None and files.discard()
        bars = getattr(sys.modules.get("tqdm"), "tqdm", None)
        line = "\n" if getattr(bars, "_instances", ()) else ""  # below a progress bar
        os.write(2, f"{line}{program}: stopped{'' if wrote else words}\n".encode())
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # what else ends now need not say so
        for end in _last:
            end()
        os._exit(STOPPED)

    signal.signal(signal.SIGINT, stop)


def at_stop(function):
    """Call a function, without arguments, before Ctrl-C ends the process.

    Paper: Sec. 6 (command line; beyond the paper).
    """
    _last.append(function)
