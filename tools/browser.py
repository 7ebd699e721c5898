"""Find Chromium for the browser tests, or install Debian's package of it.

    python tools/browser.py

Prints where it is, or why there is none: the tests then say that they were skipped."""

import os
import shutil
import subprocess
import sys

NAMES = "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"
APPLICATION = "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome"


def chromium():
    """The program's path, or None."""
    found = next((path for path in map(shutil.which, NAMES) if path), None)
    return found or (APPLICATION if os.path.exists(APPLICATION) else None)


def install():
    """Try Debian's package; a sentence on why it was not, or ""."""
    apt = shutil.which("apt-get")
    if apt is None:
        return "there is no apt-get here: install Chromium or Chrome by hand"
    if os.geteuid() != 0:
        return "only root may install packages: sudo apt-get install chromium"
    quiet = {"env": os.environ | {"DEBIAN_FRONTEND": "noninteractive"}, "stdout": sys.stderr}
    for command in (["update", "-qq"], ["install", "-y", "-qq", "chromium"]):
        if subprocess.run([apt, *command], **quiet).returncode:
            return "the package chromium could not be installed: see apt-get's message above"
    return ""


def main():
    """Exit code 0 always: without a browser the tests skip and say so."""
    reason = "" if chromium() else install()
    print(f"browser tests: {chromium() or reason or 'chromium was installed but is not found'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
