"""The project's own promises: declared packages, pins, style, nothing private in a file."""

import functools
import importlib
import inspect
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))

MODULES = sorted(
    ".".join(path.relative_to(ROOT / "inetlib").with_suffix("").parts).removesuffix(".__init__")
    for path in (ROOT / "inetlib").glob("**/*.py")
    if path.parent.name != "inetlib" or path.stem != "__init__"
)


def tracked():
    """The text files that git would commit."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    paths = [ROOT / name for name in names.splitlines()]
    return [p for p in paths if p.is_file() and p.suffix not in {".png", ".svg", ".npz"}]


def declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"].values()
    return [Requirement(r) for r in project["dependencies"] + [r for e in extras for r in e]]


@functools.cache
def public_functions():
    return list(_public_functions())


def _public_functions():
    for name in MODULES:
        module = importlib.import_module(f"inetlib.{name}")
        for key, value in vars(module).items():
            own = getattr(value, "__module__", "") == module.__name__
            if (
                own
                and not key.startswith("_")
                and (inspect.isroutine(value) or inspect.isclass(value))
            ):
                yield f"{name}.{key}", value


def test_environment_yml_is_made_from_pyproject():
    import environment

    assert (ROOT / "environment.yml").read_text() == environment.environment()


def test_every_declared_package_is_pinned_within_its_range():
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pins = dict(line.lower().split("==") for line in lines if line and not line.startswith("#"))
    assert len(declared()) > 10
    for requirement in declared():
        assert pins[requirement.name.lower()] in requirement.specifier, requirement


def test_the_oldest_set_is_every_declared_package_at_its_only_bound():
    import setup

    oldest = {r.name: r for r in map(Requirement, setup.oldest())}
    assert len(oldest) == len(setup.oldest()) == len(declared())
    for requirement in declared():
        (bound,) = requirement.specifier
        (pin,) = oldest[requirement.name].specifier
        assert (bound.operator, pin.operator) == (">=", "=="), requirement
        assert pin.version == bound.version, requirement
        assert oldest[requirement.name].extras == requirement.extras, requirement


@pytest.mark.parametrize("versions", ["pinned", "oldest", "newest"])
def test_setup_installs_the_versions_it_was_asked_for(versions, tmp_path, monkeypatch):
    """In a folder of its own and with no network: the commands are only written down."""
    import setup

    commands, folder = [], tmp_path / setup.FOLDERS[versions]
    pins = setup.oldest()

    def run(command):
        commands.append([str(word) for word in command])
        folder.mkdir(exist_ok=True)
        return 0

    folder.mkdir()
    (folder / "left").touch()
    monkeypatch.setattr(setup, "ROOT", tmp_path)
    monkeypatch.setattr(setup, "oldest", lambda: pins)
    monkeypatch.setattr(setup, "run", run)
    monkeypatch.setattr(sys, "argv", ["setup.py", "--versions", versions])
    assert setup.main() == 0
    assert commands[0] == [sys.executable, "-m", "venv", str(folder)]
    project = ["-e", ".[view,cad,test]"]
    wanted = {"pinned": ["-c", "constraints.txt"], "oldest": pins, "newest": []}[versions]
    quiet = ["--quiet", "--disable-pip-version-check"]
    assert commands[1][1:] == ["-m", "pip", "install", *quiet, *wanted, *project]
    assert (folder / "left").exists() == (versions == "pinned")
    assert f"{folder.name}/" in (ROOT / ".gitignore").read_text().split()
    monkeypatch.setattr(sys, "argv", ["setup.py", "--remove"])
    assert setup.main() == 0 and not folder.exists()


def test_the_package_list_names_every_module_folder():
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"][
        "packages"
    ]
    folders = {p.parent.relative_to(ROOT) for p in (ROOT / "inetlib").rglob("*.py")}
    assert {str(f).replace("/", ".").replace("\\", ".") for f in folders} == set(packages)


@pytest.mark.parametrize("command", [["format", "--check"], ["check"]])
def test_ruff_has_nothing_to_say(command):
    done = subprocess.run(
        [sys.executable, "-m", "ruff", *command, "."], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_file_names_a_package_index_or_somebodys_machine():
    private = re.compile(
        r"https?://\S*(?:/simple\b|pypi|pythonhosted|registry|anaconda)"
        r"|(?<![\w.])/(?:work|root|home|Users)/\w|--(?:extra-)?index-url",
        re.IGNORECASE,
    )
    for path in tracked():
        if path != Path(__file__).resolve():
            hit = private.search(path.read_text(encoding="utf-8"))
            assert hit is None, f"{path.name}: {hit[0]}"


def test_identifiers_are_ascii():
    for path in tracked():
        if path.suffix == ".py":
            assert path.read_text(encoding="utf-8").isascii(), path


def test_every_public_name_has_a_docstring():
    names = public_functions()
    assert len(names) > 40
    for name, value in names:
        doc = inspect.getdoc(value)
        assert doc, name


def test_no_module_and_no_function_outgrows_a_glance():
    for name, value in public_functions():
        methods = vars(value).values() if inspect.isclass(value) else [value]
        for function in filter(inspect.isfunction, methods):
            if not function.__code__.co_filename.startswith(str(ROOT)):
                continue  # made by dataclasses
            assert len(inspect.getsource(function).splitlines()) <= 60, (name, function)
    for path in (ROOT / "inetlib").rglob("*.py"):
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 600, path


def test_the_library_draws_without_opengl():
    code = "import sys, inetlib.plot, inetlib.publish; sys.exit('vtk' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
