"""The command line `inet`: measure, cover, web, optimize, explore, figures.

Wrong input is found before the work begins and becomes one sentence on stderr; a file is
written only after everything went well.
"""

import contextlib
import functools
import importlib
import json
import os
import sys
import warnings
import webbrowser
from pathlib import Path

import numpy as np

from . import (
    design,
    examples,
    files,
    io,
    loxodrome,
    mesh,
    options,
    paths,
    reference,
    repair,
    solver,
    surfaces,
)
from .design import report
from .mesh import boundary_loops

DONE, NOT_FOUND, WRONG, STOPPED = 0, 1, 2, 130
PROFILES = {
    "sphere": surfaces.sphere_profile,
    "torus": surfaces.torus_profile,
    "catenoid": surfaces.catenoid_profile,
    "vase": surfaces.vase_profile,
    "cone": lambda: surfaces.cone_profile(np.radians(30)),
}
SURFACES = {
    "roof": examples.wavy_roof,
    "saddle": examples.saddle_with_hole,
    "shell": examples.hanging_shell,
}
ROOT = Path(__file__).resolve().parent.parent


class Off(Exception):
    """No net with the angles was found; the sentence says what was done instead."""


def main(arguments=None):
    """Run `inet` with a list of arguments, or those of the process: the exit code.

    0 done, 1 no net with these angles was found, 2 wrong input, 130 stopped by Ctrl-C.
    """
    try:
        given = options.parser().parse_args(arguments)
    except SystemExit as end:  # help, the version, or a mistake that was already told
        return end.code
    commands = {
        "measure": _measure,
        "cover": _cover,
        "web": _web,
        "optimize": _optimize,
        "explore": _explore,
        "figures": _figures,
    }
    written = len(files.WRITTEN)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            code = commands[given.command](given)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        quiet = given.command in ("figures", "explore") or len(files.WRITTEN) > written
        return _tell("stopped" + ", nothing was written" * (not quiet), STOPPED)
    except BrokenPipeError:  # the reader of our output went away, for example `head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Off as words:
        return _tell(words, NOT_FOUND)
    except (ValueError, OSError, ImportError, RuntimeError, ArithmeticError) as error:
        return _tell(_sentence(error), WRONG)
    except MemoryError:
        return _tell("there is not enough memory for this: ask for fewer quads", WRONG)


def _tell(words, code):
    print("inet:", " ".join(str(words).split()), file=sys.stderr)
    return code


def _sentence(error):
    if isinstance(error, OSError) and error.strerror and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error) or type(error).__name__


# --- the commands -------------------------------------------------------------------------


def _measure(given):
    V, Q, polygons, notes = paths.read_net(given.net, must_label=False)
    notes += paths.turned(V, Q, given.theta, given.theta0)
    found = report.report(V, Q, polygons, **_wanted(given))
    _say(given, found, given.net, notes, labelled=mesh.is_labelled(Q))
    return DONE


def _cover(given):
    paths.check_output(given.output, given.force, given.curves)
    if given.surface in SURFACES:
        (V, F), repaired = SURFACES[given.surface](), []
    else:
        V, F, repaired = io.surface(given.surface)
    found = design.cover(
        V,
        F,
        *np.radians([given.theta, given.theta0]),
        count=given.quads,
        size=given.size,
        direction=np.radians(given.direction),
        tolerance=np.radians(given.tolerance),
        progress=_progress(given),
    )
    notes = _repairs(given.surface, [*repaired, *found.report.repairs])
    more = {"converged": found.report.converged, "message": found.report.message}
    return _finish(given, found.V, found.Q, (), found.report, notes, **more)


def _web(given):
    paths.check_output(given.output, given.force, given.curves)
    known = PROFILES.get(given.profile)
    profile = known() if known else paths.profile(_profile_file(given.profile))
    angles = np.radians([given.theta, given.theta0])
    net = loxodrome.web(profile, *angles, given.m, given.n, given.method)
    io.write(
        given.output,
        net.V,
        net.Q,
        paths.curves(given.output, net.Q, given.curves),
        force=given.force,
    )
    found = report.report(net.V, net.Q, **_wanted(given))
    rows = {"rows": net.rows, "quads_around": given.m, "message": net.message}
    _say(given, found, given.output, [], **rows)
    return DONE


def _profile_file(name):
    if not Path(name).is_file():
        known = ", ".join(PROFILES)
        raise ValueError(f"--profile {name}: neither {known} nor a file that is there")
    return name


def _optimize(given):
    paths.check_output(given.output, given.force, given.curves)
    V, Q, polygons, notes = paths.read_net(given.net)
    notes += paths.turned(V, Q, given.theta, given.theta0)
    near = None
    if given.reference is not None:
        surface = io.surface(given.reference)
        near = reference.mesh(surface.V, surface.F)
        notes += _repairs(given.reference, surface.repaired)
    rims = {frozenset(loop.tolist()) for loop in boundary_loops(Q)}
    found = solver.optimize(
        V,
        Q,
        *(None if x is None else np.radians(x) for x in (given.theta, given.theta0)),
        given.lam,
        given.mu,
        reference=near,
        on_surface=given.on_surface,
        fixed=given.fixed,
        polygons=[p for p in polygons if frozenset(np.asarray(p).tolist()) in rims],
        via=given.via,
        tolerance=np.radians(given.tolerance),
        progress=_progress(given),
    )
    more = {
        "converged": found.converged,
        "message": found.message,
        "steps": len(found.history) - 1,
        "lam": found.lam,
        "mu": found.mu,
        "seconds": found.seconds,
    }
    about = report.report(found.V, Q, polygons, **_wanted(given))
    return _finish(given, found.V, Q, polygons, about, notes, **more)


def _explore(given):
    surface = given.surface and io.surface(given.surface)
    if surface:
        repair.clean(surface.V, surface.F)  # refuses what cannot be covered
    from .explorer import notebook

    try:
        from .explorer import serve
    except ImportError as error:
        raise ImportError(notebook.MISSING) from error
    serve.serve(surface, given.surface, given.port, functools.partial(_ready, given.open))
    return DONE


def _ready(browser, address):
    print(f"Isogonal nets: {address} (Ctrl-C ends it)", flush=True)
    if browser:
        webbrowser.open(address)


def _figures(given):
    runner, folder = ROOT / "tools" / "redraw.py", ROOT / "notebooks"
    if not (runner.is_file() and folder.is_dir()):
        raise ValueError("figures: the notebooks are not here, run this in a clone of the project")
    names = [stem for name in given.names for stem in _notebooks(folder, name)]
    sys.path.insert(0, str(runner.parent))
    redraw = importlib.import_module("redraw")
    if not _progress(given):
        redraw.tqdm = functools.partial(redraw.tqdm, disable=True)
    with contextlib.redirect_stdout(None if given.quiet else sys.stdout):
        return redraw.main(list(dict.fromkeys(names)))


def _notebooks(folder, name):
    """The notebooks whose names begin so, or that draw the figure of this name."""
    found = []
    for path in sorted(folder.glob("*.ipynb")):
        if path.stem.startswith(name) or name in _tags(path):
            found.append(path.stem)
    if not found:
        raise ValueError(f"figures: no notebook begins with {name!r}, and none draws it")
    return found


def _tags(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return {tag for cell in cells for tag in cell["metadata"].get("tags", [])}


# --- after the work ------------------------------------------------------------


def _repairs(path, sentences):
    return [f"{path}: {sentence}" for sentence in dict.fromkeys(sentences)]


def _finish(given, V, Q, polygons, about, notes, **more):
    """Write the net if it is good or to be kept, and say what there is to say: exit code."""
    good = more["converged"]
    written = good or given.keep
    if written:
        lines = paths.curves(given.output, Q, given.curves)
        io.write(given.output, V, Q, lines, polygons, force=given.force)
    _say(given, about, given.output if written else None, notes, **more)
    if not good:
        what = "this net was written" if written else "nothing was written, --keep does it"
        raise Off(f"{more['message']}; {what}")
    return DONE


def _say(given, about, file, notes, **more):
    """The `Report`, the file and what else there is, in words or as JSON."""
    known = {"file": file, **report.numbers(about), **more, "notes": notes}
    if given.json:
        print(json.dumps(known, indent=2, allow_nan=False))
    elif not given.quiet:
        print(file or "not written")
        if "message" in known and known.get("converged", True):
            print(known["message"])
        print(report.text(about))
        for note in notes:
            print("note:", note)


def _wanted(given):
    degrees = {name: getattr(given, name, None) for name in report.NAMES}
    return {
        name: np.radians(x) if x is not None and name.startswith("theta") else x
        for name, x in degrees.items()
    }


def _progress(given):
    return sys.stderr.isatty() and not given.quiet
