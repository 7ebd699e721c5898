"""The command line, as a user meets it: exit codes, one sentence for a mistake, no damage."""

import json
import re
import shlex
import shutil
import subprocess
import sys
import types
from itertools import pairwise
from pathlib import Path

import igl
import numpy as np
import pytest
from test_repair import sheet

from inetlib import cli, examples, io, loxodrome, mesh, surfaces
from inetlib.cli import completion, looks, project

ANGLES = "--theta", "60", "--theta0", "45"


@pytest.fixture
def inet(capsys, tmp_path, monkeypatch):
    """inet(*arguments) -> (exit code, stdout, stderr), in an empty folder of its own."""
    monkeypatch.chdir(tmp_path)

    def run(*words):
        code = cli.main([str(word) for word in words])
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return code, out, err

    return run


@pytest.fixture
def coarse(monkeypatch):
    """Pictures take less time."""
    monkeypatch.setattr("inetlib.explorer.look.PIXELS", 120)


@pytest.fixture
def web(inet):
    """A small exact net in web.obj."""
    code, _, err = inet("web", "--profile", "sphere", *ANGLES, "-m", 12, "-n", 4, "-o", "web.obj")
    assert (code, err) == (0, "")
    return Path("web.obj")


def numbers(result):
    """What a command that went well has said with --json."""
    code, out, err = result
    assert (code, err) == (0, "")
    return json.loads(out)


def refused(result, words=""):
    """Whether it was refused with exit code 2 and one sentence that has these words."""
    code, out, err = result
    assert code == 2 and out == "", err
    assert err.startswith("inet: ") and err.count("\n") == 1
    assert words in err, err
    return True


def test_the_entry_point_runs_and_knows_its_version():
    code = "from importlib.metadata import entry_points as e; "
    code += "raise SystemExit(e(group='console_scripts', name='inet')['inet'].load()())"
    done = subprocess.run([sys.executable, "-c", code, "--version"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("inet 0.")


def test_the_explorer_as_a_module_is_the_command_of_that_name(tmp_path):
    words = [sys.executable, "-m", "inetlib.explorer", "none.obj"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert refused((done.returncode, done.stdout, done.stderr), "none.obj")


LOADED = """
import sys
from inetlib import cli
slow = {"igl", "matplotlib", "sympy", "vtkmodules", "pyvista", "scipy.interpolate"}
open("old.obj", "w").write("precious")
for row in sys.argv[1:]:
    code, words = cli.main(row.split()), slow & {*sys.modules}
    if row in ("--help", ""):
        words |= {"numpy"} & {*sys.modules}
    print(f"{code} {row}: {words or 'nothing slow'}", file=sys.stderr)
"""


def test_help_and_wrong_input_load_nothing_slow(tmp_path):
    """The first one not even NumPy: what was loaded stays so."""
    angles = "--theta 60 --theta0 45"
    rows = ["--help", "", *(f"{name} --help" for name in cli.TEXTS)]
    wrong = [
        "measure none.obj",
        "measure old.obj",
        "cover roof --theta 190 --theta0 9 -o a.obj",
        f"cover none.obj {angles} -o a.obj",
        f"cover roof {angles} --quads x -o a.obj",
        f"optimize none.obj {angles} -o a.obj",
        f"optimize old.obj {angles} -o old.obj",
        f"web --profile none {angles} -m 9 -o a.obj",
        "schedule none.obj -o a.csv",
        "schedule old.obj -o a.csv",
        "explore none.obj",
        "explore --host 0.0.0.0",
        "show none.obj",
        "show roof -o a.obj",
        "webb --profile vase",
        "figures fig99",
        "course grade none",
        "course grade . -o old.obj",
    ]
    code = [sys.executable, "-c", LOADED, *rows, *wrong]
    done = subprocess.run(code, cwd=tmp_path, capture_output=True, text=True)
    told = [line for line in done.stderr.splitlines() if not line.startswith("inet: ")]
    expected = [f"0 {row}: nothing slow" for row in rows]
    assert told == [*expected, *(f"2 {row}: nothing slow" for row in wrong)]


@pytest.mark.parametrize("command", cli.TEXTS)
def test_every_help_text_shows_its_examples_and_they_run(inet, coarse, command):
    code, out, err = inet(command, "--help")
    assert (code, err) == (0, "") and max(len(line) for line in out.splitlines()) <= 100
    io.write("roof.obj", *examples.wavy_roof(15))
    Path("submissions").mkdir()
    Path("submissions", "a.ipynb").write_text('{"nbformat": 4, "cells": []}')
    text, *lines = cli.TEXTS[command]
    assert text in out and len(lines) > 1
    for line in lines:
        first, *words = shlex.split(line)
        assert first == "inet" and f"  {line}\n" in out
        if command == "figures":
            found = [w for w in words[1:] if not w.startswith("-") and w != "."]
            assert all(project.notebooks(project.ROOT / "notebooks", name) for name in found)
        elif words[0] != "explore" and "--open" not in words:
            code, told, err = inet(*words)
            assert (code, err) == (0, "") and told, line
            assert "-o" not in words or Path(words[words.index("-o") + 1]).is_file()


def test_the_overview_shows_all_commands_with_examples_that_can_be_run_in_this_order(inet):
    code, out, err = inet()
    assert (code, err) == (0, "") and inet("--help") == inet("help") == (code, out, err)
    assert max(len(line) for line in out.splitlines()) <= 100
    lines = [line.split()[1:] for line in out.splitlines() if line.startswith(" " * 13 + "inet ")]
    assert sorted(line[0] for line in lines) == sorted(cli.COMMANDS) == sorted(cli.TEXTS)
    made = set()
    for name, *words in lines:  # each of them is run by the test above
        assert cli.TEXTS[name][0] in out and " ".join(["inet", name, *words]) in cli.TEXTS[name]
        made |= {word for before, word in pairwise(words) if before == "-o"}
        assert {word for word in words if word.endswith(".obj")} <= made, words
    assert inet("help", "web") == inet("web", "--help")


@pytest.mark.parametrize("words", [["nets"], ["measure"], ["web", "-o", "a.obj"], ["--what"]])
def test_what_is_missing_or_unknown_is_said_in_one_sentence(inet, words):
    assert refused(inet(*words), "--help")


NEAREST = {
    "mesure a.obj": "did you mean measure?",
    "optimise a.obj": "did you mean optimize?",
    "xyz": "there are examples, show,",
    "measure a.obj b.obj": "b.obj is a word too many (quote names with spaces)",
    "cover rof --theta 60 --theta0 60 -o a.obj": "no example: did you mean roof?",
    "web --profile vaze --theta 60 --theta0 60 -m 12 -o a.obj": "did you mean vase?",
    "cover roof --thta 60": "did you mean --theta?",
    "cover roof --theta=60 --quad=9": "did you mean --quads?",
    "web -q 3": "web has no option -q: ",
    "--versoin": "did you mean --version?",
    "explore --server": "without a browser anyway",
    "explore --host 0.0.0.0": "always local",
    "explore roof.obj --host=example.org": "only this machine",
    "show a.obj --families u,w": "u, v, d1, d2, or none",
    "show a.obj --view 3": "AZIMUTH,ELEVATION",
    "show a.obj -o a.obj": ".png or .svg",
}


@pytest.mark.parametrize("line", NEAREST)
def test_the_nearest_name_is_told(inet, line):
    assert refused(inet(*line.split()), NEAREST[line])


def test_a_value_that_begins_with_a_minus_sign_is_no_option(inet):
    assert cli.joined(["--align", "-1,0,0", "-m", "-5", "a.obj", "--view=-5,3", "-.5"]) == [
        "--align=-1,0,0", "-m", "-5", "a.obj", "--view=-5,3", "-.5"
    ]  # fmt: skip
    io.write("roof.obj", *examples.wavy_roof(9))
    words = "--theta", 60, "--theta0", "60\u00b0", "--quads", 60, "--align", "-1,0,0", "-o", "a.obj"
    found = numbers(inet("cover", "roof.obj", *words, "--json"))
    assert found["wanted"]["theta0"] == pytest.approx(60)


@pytest.mark.parametrize("module", ["inetlib", "inetlib.cli"])
def test_the_package_is_the_command(module, tmp_path):
    words = [sys.executable, "-m", module, "--version"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("inet 0.")


def test_the_examples_are_those_that_the_commands_know(inet):
    found = numbers(inet("examples", "--json"))
    assert [*found["surfaces"]] == [*examples.SURFACES]
    assert [*found["profiles"]] == [*surfaces.PROFILES]
    assert {"square", "exp"} < {*found["explorer"]["map"]}
    out = inet("examples")[1]
    for group in ("surfaces", "profiles"):
        for name, words in found[group].items():
            assert f"  {name:16}{words}\n" in out and words.startswith(("A ", "An ", "The "))


def test_a_picture_of_a_net_or_a_surface_is_drawn_and_not_overwritten(inet, coarse, web):
    V, Q, polygon = mesh.polygon_rings(5, 2)
    io.write("five.obj", V, Q, polygons=[polygon])
    for words in (["roof", "-o", "a.png"], [web, "-o", "a.svg", "--view", "-30,20"]):
        code, out, err = inet("show", *words)
        assert (code, err) == (0, "") and out.startswith(f"{words[2]}\n")
        assert refused(inet("show", *words), "--force")
    assert (
        Path("a.png").read_bytes().startswith(b"\x89PNG") and b"<svg" in Path("a.svg").read_bytes()
    )
    first = Path("a.svg").read_bytes()
    assert inet("show", web, "--families", "d1", "--parallelograms", "-o", "b.svg")[0] == 0
    assert Path("b.svg").read_bytes() != first
    found = numbers(inet("show", "five.obj", "-o", "a.png", "--force", "--json"))
    assert (found["vertices"], found["faces"]) == (len(V), len(Q) + 1)
    assert "no consistent u/v labelling" in found["notes"][0]
    corners, wings = np.eye(4)[:, :3], [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    io.write("closed.obj", corners, np.array(wings))  # no surface to cover, but one to look at
    assert inet("show", "closed.obj", "-o", "closed.svg")[0] == 0
    assert refused(inet("show", "closed.obj"), "(with -o FILE.png it is drawn as it is)")


TRY = """
. ./inet.sh
try() { COMP_WORDS=("$@"); COMP_CWORD=$(( $# - 1 )); _inet; printf '%s|' "${COMPREPLY[@]}"; echo; }
"""
TABS = {  # what is typed, and what may follow
    "inet m": "measure|",
    "inet web --prof": "--profile|",
    "inet web --profile s": "sphere|some net.obj|",
    "inet cover --openings ''": "fill|ring|",
    "inet cover ro": "roof|",
    "inet cover roof --th": "--theta|--theta0|--through|",
    "inet cover roof --theta ''": "|",
    "inet measure so": "some net.obj|",
    "inet show roof -o so": "some net.obj|",
    "inet explore --host l": "localhost|",
    "inet completion ''": "bash|zsh|fish|",
}


@pytest.mark.skipif(not shutil.which("bash"), reason="there is no bash here")
def test_bash_completes(inet):
    code, out, err = inet("completion", "bash")
    assert (code, err) == (0, "")
    Path("inet.sh").write_text(out)
    Path("some net.obj").touch()
    script = TRY + "\n".join(f"try {line}" for line in TABS)
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True)
    assert (done.stdout.splitlines(), done.stderr) == ([*TABS.values()], "")


@pytest.mark.parametrize("shell", completion.SHELLS)
def test_all_commands_and_options_are_in_the_script_of_each_shell(inet, shell):
    code, out, err = inet("completion", shell)
    assert (code, err) == (0, "")
    Path("script").write_text(out)
    if shutil.which(shell):
        assert subprocess.run([shell, "-n", "script"], capture_output=True).returncode == 0
    for name, command in cli.parsers([*cli.TEXTS])[1].items():
        there = [line for line in out.splitlines() if name in line]
        for option in completion.options(command):
            word = (
                option
                if shell != "fish"
                else f" {'-l' if '--' in option else '-s'} {option.lstrip('-')} "
            )
            assert any(word in line for line in there), (name, option)


def test_measure_prints_the_angles_and_json_the_same(inet, web):
    code, out, err = inet("measure", web, *ANGLES)
    assert (code, err) == (0, "")
    assert "48 quads" in out and "60.000000000" in out and "45.000000000" in out
    found = numbers(inet("measure", web, "--json"))
    assert found["quads"] == 48 and found["labelled"] and found["flips"] == 0
    assert found["angles"]["theta"]["mean"] == pytest.approx(60, abs=1e-9)
    assert found["angles"]["theta0"]["mean"] == pytest.approx(45, abs=1e-9)
    assert found["deviation"] < 1e-9
    found = numbers(inet("measure", web, "--theta", 61, "--theta0", 45, "--json"))
    assert found["deviation"] == pytest.approx(1, abs=1e-9)
    assert found["wanted"] == pytest.approx({"theta": 61, "theta0": 45, "lam": None, "mu": None})


def test_faces_that_disagree_on_u_and_v_are_labelled_and_a_turned_net_is_noticed(inet, web):
    V, Q, _ = io.net(web)
    mixed = Q.copy()
    mixed[1::2] = np.roll(mixed[1::2], 1, axis=1)
    io.write("mixed.obj", V, mixed)
    code, out, _ = inet("measure", "mixed.obj", *ANGLES)
    assert code == 0 and "note: the faces did not agree" in out and "45.000000000" in out
    io.write("turned.obj", V, np.roll(Q, 1, axis=1))
    code, out, _ = inet("measure", "turned.obj", *ANGLES)
    assert code == 0 and "exchanged" in out and "135.000000000" in out


def test_a_mesh_without_labels_is_measured_but_not_optimised_and_a_net_around_a_hexagon_is(inet):
    V, Q, polygon = mesh.polygon_rings(5, 2)
    io.write("five.obj", V, Q, polygons=[polygon])
    found = numbers(inet("measure", "five.obj", "--json"))
    assert found["polygons"] == [5] and not found["labelled"] and "odd" in found["notes"][0]
    assert "1 other faces, with 5 corners" in inet("measure", "five.obj")[1]
    assert refused(inet("optimize", "five.obj", *ANGLES, "-o", "a.obj"), "odd")
    assert not Path("a.obj").exists()
    V, Q, polygon = mesh.polygon_rings(6, 3)
    io.write("six.obj", V, Q, polygons=[polygon])
    code, out, _ = inet("optimize", "six.obj", "--theta", 80, "--theta0", 80, "-o", "a.obj")
    assert code == 0 and "1 other faces, with 6 corners" in out
    assert io.net("a.obj").polygons[0].tolist() == polygon.tolist()


BAD = {
    "nan.obj": b"v 0 0 0\nv 1 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3 4\n",
    "line.obj": b"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n",
    "missing.obj": None,
    "triangles.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",  # no net
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_by_name(inet, name):
    if BAD[name] is not None:
        Path(name).write_bytes(BAD[name])
    before = list(Path().iterdir())
    known = "" if name == "line.obj" else name
    assert refused(inet("measure", name), known)
    assert refused(inet("optimize", name, *ANGLES, "-o", "a.obj"), known)
    assert name == "triangles.obj" or refused(inet("cover", name, *ANGLES, "-o", "a.obj"), known)
    assert list(Path().iterdir()) == before


@pytest.mark.parametrize(
    "value", ["0", "1e-9", "179.999", "180", "-60", "240", "nan", "inf", "right"]
)
@pytest.mark.parametrize("name", ["--theta", "--theta0"])
def test_angles_lie_between_0_and_180(inet, name, value):
    words = ["web", "--profile", "vase", *ANGLES, "-m", 12, "-o", "a.obj", f"{name}={value}"]
    assert refused(inet(*words), f"{value} is given, an angle above 0 and below 180")


WRONG = {
    "web --profile=vase -m 12": ["-m 0", "-m 2.5", "-n x", "-m 2", "--method fast"],
    "cover roof.obj": ["--quads 0", "--size -1", "--direction nan", "--size 1 --quads 9"],
}


@pytest.mark.parametrize("command", WRONG)
def test_numbers_and_choices_are_checked(inet, command):
    for words in WRONG[command]:
        result = inet(*command.split(), *ANGLES, "-o", "a.obj", *words.split())
        assert refused(result, words.split()[-2].strip("-")), words


@pytest.mark.parametrize("output", ["a.xyz", "a", "no folder/a.obj", "folder.obj", "old.obj"])
@pytest.mark.parametrize("command", ["web", "optimize", "cover"])
def test_outputs_are_checked_before_the_work(inet, monkeypatch, command, output):
    def work(*ignored, **also):
        raise AssertionError("began")

    for module, name in ((io, "net"), (io, "surface"), (loxodrome, "web")):
        monkeypatch.setattr(module, name, work)
    Path("folder.obj").mkdir()
    Path("old.obj").write_text("precious")
    first = ["web", "--profile=vase", "-m", 12] if command == "web" else [command, "in.obj"]
    assert refused(inet(*first, *ANGLES, "-o", output), output.split("/")[0])
    assert Path("old.obj").read_text() == "precious"


def test_force_replaces_and_a_failed_run_does_not(inet, web):
    before = web.read_bytes()
    far = "--theta", 80, "--theta0", 100, "--fixed", "boundary"
    assert inet("optimize", web, *far, "-o", web, "--force")[0] == 1
    assert web.read_bytes() == before
    assert inet("web", "--profile=vase", *ANGLES, "-m", 12, "-o", web, "--force")[0] == 0
    assert web.read_bytes() != before


@pytest.mark.parametrize("profile", surfaces.PROFILES)
def test_webs_on_the_known_profiles_with_curves_on_request(inet, profile):
    words = "web", "--profile", profile, *ANGLES, "-m", 16, "--json", "-o"
    found = numbers(inet(*words, "a.obj"))
    assert found["deviation"] < 1e-9 and found["quads"] == 16 * found["rows"]
    before = Path("a.obj").read_bytes()
    numbers(inet(*words, "a.obj", "--curves", "--force"))
    assert b"\nl " in Path("a.obj").read_bytes() and b"\nl " not in before
    assert refused(inet(*words, "a.ply", "--curves"), "curves")


def test_a_web_on_a_profile_from_a_file(inet):
    t = np.linspace(0, 3, 20)
    rows = [f"{2 + np.sin(x):.6f}, {x:.6f}" for x in t]
    Path("my jar.csv").write_text("radius, height\n" + "\n".join(rows))
    assert inet("web", "--profile", "my jar.csv", *ANGLES, "-m", 20, "-o", "a.obj")[0] == 0
    V = io.net("a.obj").V
    assert np.abs(np.hypot(V[:, 0], V[:, 1]) - 2 - np.sin(V[:, 2])).max() < 1e-3


BAD_PROFILES = {
    "": "two rows",
    "radius,height\n1,0\n": "two rows",
    "1,0\n1;2,3\n": "line 2",
    "1,0\nx,1\n": "line 2",
    "1,0\n-1,1\n": "positive",
}


@pytest.mark.parametrize("text", BAD_PROFILES)
def test_bad_profiles_are_refused(inet, text):
    Path("jar.csv").write_text(text)
    result = inet("web", "--profile", "jar.csv", *ANGLES, "-m", 20, "-o", "a.obj")
    assert refused(result, BAD_PROFILES[text]) and not Path("a.obj").exists()


def test_unknown_profiles_and_rows_that_do_not_fit(inet):
    words = [*ANGLES, "-m", 12, "-o", "a.obj"]
    assert refused(inet("web", "--profile", "spere", *words), "sphere")
    assert refused(inet("web", "--profile=sphere", *words, "--theta=170", "-m", 3), "not one row")
    code, out, _ = inet("web", "--profile", "sphere", "-n", 500, *words)
    assert code == 0 and "of 500 rows" in out


def test_optimize_meets_the_angles_near_a_reference(inet):
    V, Q = surfaces.freeform_patch(8, 8)
    io.write("patch.obj", V, Q)
    words = ["optimize", "patch.obj", *ANGLES, "--reference", "patch.obj", "--on-surface"]
    found = numbers(inet(*words, "-o", "a.obj", "--json"))
    assert found["converged"] and found["deviation"] < 1e-8 and found["file"] == "a.obj"
    off = igl.point_mesh_squared_distance(io.net("a.obj").V, V, mesh.triangles(V, Q)[1])[0] ** 0.5
    far = [found["distance_mean"], found["distance_max"]]
    assert far == pytest.approx([off.mean(), off.max()], abs=1e-9) and "distance_mean" in found
    far = numbers(inet(*words[:-1], "-o", "b.obj", "--json"))["distance_max"]
    assert found["distance_max"] < far / 10
    again = numbers(inet("measure", "a.obj", *ANGLES, "--json"))
    assert again["deviation"] == pytest.approx(found["deviation"], abs=1e-9)


def test_optimize_with_ratios_and_too_many_numbers(inet, web):
    words = "--lam", 1.2, "--mu", 1.1, "-o", "a.obj", "--json"
    found = numbers(inet("optimize", web, *words))
    assert found["ratios"]["lam"]["max_deviation"] < 1e-9
    assert refused(inet("optimize", web, *ANGLES, "--lam", 1.2, "-o", "b.obj"), "drop")
    assert refused(inet("optimize", web, *ANGLES, "--on-surface", "-o", "b.obj"), "reference")


def test_a_net_that_is_off_is_kept_only_when_asked_for(inet, web):
    words = "optimize", web, "--theta", 80, "--theta0", 100, "--fixed", "boundary", "-o", "a.obj"
    code, out, err = inet(*words, "--json")
    assert code == 1 and json.loads(out)["file"] is None
    assert "not converged" in err and "--keep" in err and not Path("a.obj").exists()
    code, out, err = inet(*words, "--keep", "--quiet")
    assert (code, out) == (1, "") and "was written" in err and Path("a.obj").is_file()
    assert numbers(inet(*words, "--tolerance", 90, "--force", "--json"))["converged"]


def test_figures_needs_a_clone_and_names_that_are_there(inet, monkeypatch, tmp_path):
    folder = project.ROOT / "notebooks"
    assert project.notebooks(folder, "fig03") == ["3_3_conformal_grids"]
    assert project.notebooks(folder, "5_") == sorted(p.stem for p in folder.glob("5_*.ipynb"))
    assert refused(inet("figures", "--folder", project.ROOT, "fig99"), "fig99")
    assert refused(inet("figures"), f"{tmp_path} is no clone")
    assert refused(inet("figures", "--folder", "none"), "--folder")
    for name in ("tools", "notebooks"):
        (tmp_path / name).mkdir()
    (tmp_path / "tools" / "redraw.py").touch()
    assert refused(inet("figures"), f"is of {project.ROOT}")


def test_surfaces_are_repaired_and_it_is_said_or_refused(inet):
    V, F = examples.wavy_roof(15)
    words = *ANGLES, "--quads", 80, "-o", "a.obj"
    io.write("two roofs.ply", np.concatenate([V, V + 9]), np.concatenate([F, F[9:] + len(V)]))
    assert refused(inet("cover", "two roofs.ply", *words), "--piece 1 or --largest")
    assert refused(
        inet("cover", "two roofs.ply", *words, "--piece", 7), "piece 7: the surface has 2"
    )
    assert not Path("a.obj").exists()
    for choice in (["--largest"], ["--piece", 2]):
        code, out, _ = inet("cover", "two roofs.ply", *words, *choice, "--force")
        assert code == 0 and f"piece {[1, *choice[1:]][-1]} of 2" in out
    F[::3] = F[::3, ::-1]
    io.write("flipped.ply", V, F)
    io.write("soup.ply", V[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3))
    for name in ("flipped.ply", "soup.ply"):
        found = numbers(inet("cover", name, *words, "--force", "--json"))
        assert found["converged"] and found["flips"] == 0 and 40 < found["quads"] < 160
        assert numbers(inet("measure", "a.obj", *ANGLES, "--json"))["deviation"] < 1e-6
        assert found["notes"] and all(n.startswith(f"{name}: ") for n in found["notes"])


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other words for a closed pipe")
def test_a_reader_that_goes_away_is_no_mistake(inet, web):
    code = "from inetlib.start import main; raise SystemExit(main())"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", code, "measure", web], **pipes) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 0


def test_the_stages_are_told_where_somebody_looks_on(inet, monkeypatch):
    io.write("roof.obj", *examples.wavy_roof(12))
    words = "cover", "roof.obj", *ANGLES, "--quads", 60, "-o", "a.obj", "--force"
    assert inet(*words)[2] == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    code, _, err = inet(*words)
    stages = "reading roof.obj", "checking", "flattening", "laying", "optimising", "measuring"
    places = [err.find(stage) for stage in stages]
    assert code == 0 and -1 not in places and places == sorted(places)
    assert inet(*words, "--quiet") == (0, "", "")


ERRORS = [
    (MemoryError(), "there is not enough memory for this: ask for fewer quads"),
    (PermissionError(13, "Permission denied", "jar.csv"), "jar.csv: Permission denied"),
    (OSError(28, "No space left on device"), "[Errno 28] No space left on device"),
    (ArithmeticError(), "ArithmeticError"),
    (RuntimeError("two\n  lines"), "two lines"),
]


@pytest.mark.parametrize(("error", "words"), ERRORS)
def test_whatever_goes_wrong_is_one_sentence_and_nothing_is_written(
    inet, monkeypatch, error, words
):
    def fail(*_):
        raise error

    monkeypatch.setattr(loxodrome, "web", fail)
    result = inet("web", "--profile=vase", *ANGLES, "-m", 12, "-o", "a.obj")
    assert refused(result) and result[2] == f"inet: {words}\n"
    assert not any(Path().iterdir())


def test_explore_and_show_serve_what_is_sound_and_tell_the_address(inet, web, monkeypatch):
    served, shown = [], []

    def serve(surface, path, port, ready, net=None):
        served.append((surface, path, port, net))
        ready("http://127.0.0.1:8123/")

    module = types.SimpleNamespace(serve=serve)
    monkeypatch.setattr("inetlib.explorer.notebook.server", lambda: module)
    monkeypatch.setattr(looks.webbrowser, "open", shown.append)
    V, F = examples.wavy_roof(15)
    io.write("roof.obj", V, F)
    said = "Isogonal nets: http://127.0.0.1:8123/ (Ctrl-C ends it)\n"
    assert inet("explore") == (0, said, "") and served.pop() == (None, None, None, None)
    assert inet("explore", "--host", "localhost") == (0, said, "") and served.pop() and not shown
    for command in ("explore", "show"):
        assert inet(command, "roof.obj", "--port", 8123, "--open") == (0, said, "")
        surface, *more = served.pop()
        assert np.array_equal(surface.V, V) and more == ["roof.obj", 8123, None]
        assert shown.pop() == "http://127.0.0.1:8123/"
        out = numbers(inet(command, "skylight", "--json"))
        assert out["address"].endswith("/?kind=cover&source=skylight")
        assert served.pop() == (None, None, None, None)
    assert inet("show", web) == (0, said, "")
    (*none, net) = served.pop()
    assert none == [None, "web.obj", None] and np.array_equal(net[1], io.net(web).Q)
    io.write("two.obj", np.concatenate([V, V + 9]), np.concatenate([F, F + len(V)]))
    monkeypatch.setattr(module, "serve", lambda *_: Path("none/at all").read_text())
    assert refused(inet("explore", "--port", 80), "the port 80 cannot be opened, leave --port out")
    assert refused(inet("explore", "two.obj"), "two.obj: the surface has 2 separate pieces")
    assert not served


FAKE = """
import sys
def tqdm(**options):
    return options
drawn = {}
def stamps():
    return dict(drawn)
def main(names):
    drawn["fig01"] = 1
    print(names, tqdm(total=3))
    return 0
"""


def test_figures_runs_each_notebook_once_and_names_its_target(inet, monkeypatch, tmp_path):
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "redraw.py").write_text(FAKE)
    (tmp_path / "notebooks").mkdir()
    for name, tags in (("1_one", ["fig01", "fig02"]), ("2_two", [])):
        notebook = {"cells": [{"metadata": {"tags": tags}}, {"metadata": {}}]}
        (tmp_path / "notebooks" / f"{name}.ipynb").write_text(json.dumps(notebook))
    monkeypatch.setattr(project, "ROOT", tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    for words, names in ((["2", "fig02", "1"], ["2_two", "1_one"]), ([], [])):
        for how in ("", "--quiet", "--json"):
            monkeypatch.delitem(sys.modules, "redraw", raising=False)
            code, out, err = inet("figures", *words, *[how] * bool(how))
            assert (code, err) == (0, "")
            said = ", ".join(names) or "all notebooks"
            text = f"redraws {said} in {tmp_path}\n{names} {{'disable': True, 'total': 3}}\n"
            assert how == "--json" or out == ("" if how else text)
            known = {"folder": str(tmp_path), "notebooks": names, "written": ["fig01"]}
            assert how != "--json" or json.loads(out) == known
    monkeypatch.delitem(sys.modules, "redraw")


SAID = {
    "web": "--profile vase --theta 75 --theta0 60 -m 24 -n 4 -o net.obj --planar-report 0.01",
    "cover": "roof.obj --theta 60 --theta0 60 --quads 60 --trim -o a.obj --planar-report 0.01",
    "optimize": "net.obj --theta 80 --theta0 70 --reference net.obj -o b.obj --planar-report 1",
    "measure": "net.obj --planar-report 0.01",
    "schedule": "net.obj -o panels.csv",
    "show": "net.obj -o net.svg",
    "course": "grade .",
    "examples": "",
}


def test_the_readme_documents_what_json_says(inet, coarse):
    table = (project.ROOT / "README.md").read_text(encoding="utf-8").partition("| field | of |")[2]
    rows = re.findall(r"^\| (`.*`) \| ([a-z, ]+) \| .+ \|$", table, re.M)
    documented = {name: set() for name in [*SAID, "figures", "explore"]}
    for fields, commands in rows:
        for name in commands.split(", "):
            documented[name] |= set(re.findall(r"`(\w+)`", fields))
    assert documented.pop("figures") == {"folder", "notebooks", "written"}  # as tested above
    assert documented.pop("explore") == {"address"} <= documented["show"]
    documented["show"].remove("address")
    io.write("roof.obj", *examples.wavy_roof(12))
    Path("a.ipynb").write_text('{"nbformat": 4, "cells": []}')
    for name, line in SAID.items():
        found = numbers(inet(name, *line.split(), "--json"))
        assert {*found} == documented[name], name
        for row in found["notebooks"] if name == "course" else []:
            assert {*row} == {"file", "grades", "word", "right"}


@pytest.mark.parametrize("suffix", io.PACKAGES)
def test_a_missing_package_is_named_before_the_work(inet, monkeypatch, suffix):
    monkeypatch.setattr(io.importlib.util, "find_spec", lambda name: None)
    words = "web", "--profile=cone", *ANGLES, "-m", 8, "-o", f"a{suffix}"
    assert refused(inet(*words), "pip install")


def test_the_command_line_trims_and_says_so_and_refuses(inet):
    V, Q = sheet(12, 8, lambda u, v: (12 * u, 8 * v, 0 * u))
    off = np.abs(V[Q].mean(axis=1) - [5, 4, 0])
    nested = V, Q[(off[:, :2].max(axis=1) > 3) | (off[:, :2].max(axis=1) < 2)]
    touching = V, np.delete(Q, [3, 12], axis=0)
    io.write("nested.obj", *nested)
    io.write("touching.obj", *touching)
    io.write("plate.obj", V, Q)
    words = "--theta", 60, "--theta0", 60, "--quads", 60, "--trim", "-o", "net.obj"
    for more, said in (
        (["nested.obj"], "2 separate pieces"),
        (["nested.obj", "--piece", 7], "piece 7: the surface has 2 separate pieces"),
        (["touching.obj"], "two fans"),
        (["plate.obj", "--through", "1e4,0,0"], "through"),
        (["plate.obj", "--through", "1,2"], "x,y,z"),
        (["plate.obj", "--align", "nan,0,0"], "x,y,z"),
        (["plate.obj", "--along", "edge"], "boundary"),
        (["plate.obj", "--piece", 0], "from 1 upwards"),
    ):
        assert refused(inet("cover", *more, *words), said)
    assert refused(inet("cover", "plate.obj", "--theta", 60, "--theta0", 60, "--trim", "--size",
                        "nan", "-o", "net.obj"), "nan")  # fmt: skip
    code, out, _ = inet("cover", "nested.obj", "--largest", *words, "--along", "boundary",
                        "--through", "1,1,0", "--curves")  # fmt: skip
    assert code == 0 and "piece 1 of 2 is covered" in out and "cut panels, the smallest" in out
    found = io.net("net.obj")
    assert found.polygons and len(found.Q) > 20
