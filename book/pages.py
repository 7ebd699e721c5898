"""The pages of the book: written here, or made of the project's files."""

import shutil
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent


def write(source: Path):
    """Write all pages into a folder."""
    for page in HERE.glob("*.md"):
        shutil.copyfile(page, source / page.name)
