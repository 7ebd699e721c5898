"""Nets that turn: the scenes that `viewer.js` shows, one script file each."""

from pathlib import Path


def write(folder: Path):
    """Write all scenes into a folder."""
    folder.mkdir()
