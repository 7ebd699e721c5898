"""Write environment.yml, for conda, from pyproject.toml: the one place for dependencies.

python tools/environment.py"""

import tomllib
from pathlib import Path

PIP_ONLY = (
    "libigl",
    "rhino3dm",
    "django-static-mathjax",
    "sphinx-revealjs",
)  # conda-forge has the first under another name, igl
ROOT = Path(__file__).resolve().parent.parent


def environment():
    """The text of environment.yml."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    packages = [*project["dependencies"], *(name for extra in extras.values() for name in extra)]
    lines = [
        "# Made by tools/environment.py from pyproject.toml: change it there.",
        "name: inetlib",
        "channels:",
        "  - conda-forge",
        "dependencies:",
        f"  - python{project['requires-python']}",
        "  - pip",
        *(f"  - {package}" for package in packages if not by_pip(package)),
        "  - pip:",
        *(f"      - {package}" for package in packages if by_pip(package)),
        "      - -e .",
    ]
    return "\n".join(lines) + "\n"


def by_pip(package):
    """Whether conda lacks the package: it has no extras, and not everything."""
    return "[" in package or package.startswith(PIP_ONLY)


if __name__ == "__main__":
    (ROOT / "environment.yml").write_text(environment(), encoding="utf-8")
