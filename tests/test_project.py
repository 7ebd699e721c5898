"""The project's own promises: declared packages, pins, style, nothing private in a file."""

import ast
import doctest
import functools
import importlib
import inspect
import re
import subprocess
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
MODULES = sorted(
    ".".join(path.relative_to(ROOT / "inetlib").with_suffix("").parts).removesuffix(".__init__")
    for path in (ROOT / "inetlib").glob("**/*.py")
    if path.parent.name != "inetlib" or path.stem != "__init__"
)
PICTURES = {"drawings", "explorer", "plot", "publish", "view"}  # not the library proper


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
def public():
    """{"room.name": function or class} of all that a room has of its own, without underscore."""
    return {
        f"{name}.{key}": value
        for name in MODULES
        for key, value in vars(importlib.import_module(f"inetlib.{name}")).items()
        if getattr(value, "__module__", "") == f"inetlib.{name}"
        and not key.startswith("_")
        and (inspect.isroutine(value) or inspect.isclass(value))
    }


@functools.cache
def imports():
    """{room: [(room it imports, name it takes from there or None)]}, in functions too."""
    found, rooms = {}, {"inetlib", *(f"inetlib.{name}" for name in MODULES)}
    for path in (ROOT / "inetlib").rglob("*.py"):
        parts = path.relative_to(ROOT).with_suffix("").parts
        package = parts[:-1]
        here = ".".join(package if path.stem == "__init__" else parts)
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        pairs, known = [], {}
        for node in (n for n in nodes if isinstance(n, ast.ImportFrom)):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            source = ".".join([*base, *(node.module or "").split(".")]).strip(".")
            for alias in node.names:
                inner = f"{source}.{alias.name}"
                pairs.append((inner, None) if inner in rooms else (source, alias.name))
                known[alias.asname or alias.name] = inner
        for node in (n for n in nodes if isinstance(n, ast.Attribute)):
            if isinstance(node.value, ast.Name) and node.value.id in known:
                pairs.append((known[node.value.id], node.attr))
        found[here] = [pair for pair in pairs if pair[0] in rooms]
    return found


def test_environment_yml_is_made_from_pyproject():
    import environment

    assert (ROOT / "environment.yml").read_text() == environment.environment()


def test_every_declared_package_is_pinned_and_has_one_oldest_version_in_its_range():
    import setup

    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pins = dict(line.lower().split("==") for line in lines if line and not line.startswith("#"))
    oldest = {r.name: r for r in map(Requirement, setup.oldest())}
    assert len(oldest) == len(setup.oldest()) == len(declared()) > 10
    for requirement in declared():
        assert pins[requirement.name.lower()] in requirement.specifier, requirement
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
    project = ["-e", ".[view,cad,book,test]"]
    wanted = {"pinned": ["-c", "constraints.txt"], "oldest": pins, "newest": []}[versions]
    quiet = ["--quiet", "--disable-pip-version-check"]
    assert commands[1][1:] == ["-m", "pip", "install", *quiet, *wanted, *project]
    assert (folder / "left").exists() == (versions == "pinned")
    assert f"{folder.name}/" in (ROOT / ".gitignore").read_text().split()
    monkeypatch.setattr(sys, "argv", ["setup.py", "--remove"])
    assert setup.main() == 0 and not folder.exists()


def test_the_package_list_names_every_module_folder():
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]
    packages = tools["setuptools"]["packages"]
    folders = {p.parent.relative_to(ROOT) for p in (ROOT / "inetlib").rglob("*.py")}
    assert {str(f).replace("/", ".").replace("\\", ".") for f in folders} == set(packages)


@pytest.mark.parametrize("command", ["ruff format --check .", "ruff check .", "mypy"])
def test_what_reads_the_code_has_nothing_to_say(command):
    words = [sys.executable, "-m", *command.split()]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_examples_in_docstrings_come_out_as_they_stand():
    found = [doctest.testmod(importlib.import_module(f"inetlib.{name}")) for name in MODULES]
    assert sum(result.attempted for result in found) > 5
    assert not any(result.failed for result in found)


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


def test_every_public_name_has_a_docstring_and_functions_of_the_library_say_their_types():
    assert len(public()) > 40
    for name, value in public().items():
        assert inspect.getdoc(value), name
        if inspect.isfunction(value) and name.partition(".")[0] not in PICTURES:
            signature = inspect.signature(value)
            bare = [p.name for p in signature.parameters.values() if p.annotation is p.empty]
            assert not bare, f"{name}: {', '.join(bare)}"
            assert signature.return_annotation is not signature.empty, name


def test_the_rooms_import_each_other_in_one_direction():
    graph = {here: {there for there, _ in pairs} for here, pairs in imports().items()}
    assert len(graph) > 20 and "inetlib.mesh" in graph["inetlib.measure"]
    try:
        list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


def test_no_room_takes_a_private_name_of_another():
    for here, pairs in imports().items():
        for there, name in pairs:
            words = [*there.split("."), name or ""]
            hidden = [w for w in words if w.startswith("_") and not w.endswith("__")]
            assert not hidden, f"{here}: {there}.{name}"


def test_no_room_and_no_function_outgrows_a_glance():
    for path in (ROOT / "inetlib").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= 600, path
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                body = node.body[1:] if ast.get_docstring(node) else node.body
                lines = body[-1].end_lineno - body[0].lineno + 1 if body else 0
                assert lines <= 50, (path.name, node.name, lines)
