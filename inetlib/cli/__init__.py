"""The command line `inet`; angles are degrees on it, and radians from the parser on.

Wrong input becomes one sentence, before the work begins and anything slow is loaded; files are
written after all went well."""

import argparse
import os
import re
import sys
import warnings

from .. import __version__, files
from . import completion, looks, nets, project
from .options import nearest, tell

DONE, WRONG, STOPPED = 0, 2, 130
ABOUT = """\
Isogonal nets: quad meshes whose mid-edge parallelograms are all similar.

theta is the angle between the diagonals of a quad, theta0 the angle between the lines
that join the midpoints of opposite sides; both in degrees, the same in every quad."""
EPILOG = """\
`inet COMMAND --help` has all options and more examples; `inet --version`.

exit codes: 0 done; 1 no net with these angles was found; 2 wrong input, nothing was
written; 130 stopped by Ctrl-C.  --json prints one JSON object, see README.md."""
PURPOSES = {
    "to look": "examples show explore",
    "to make a net": "web cover optimize",
    "to judge it and to build it": "measure schedule",
    "the course, the project, the shell": "course figures completion",
}
HELP = {  # what a command does, and examples: the first of its own stands in the overview
    "examples": """What there is to try: surfaces, profiles, and what the explorer knows.
        inet examples
        inet examples --json""",
    "show": """Look at a net or a surface, in the browser or as a picture.
        inet show roof -o roof.png
        inet web --profile vase --theta 75 --theta0 60 -m 24 -o vase.obj
        inet show vase.obj --families u,v,d1 --view=-60,20 -o vase.svg
        inet show vase.obj --open""",
    "explore": """Turn the angles of a net in the browser, on this machine only.
        inet explore --open
        inet explore skylight --open
        inet explore roof.obj --port 8000""",
    "web": """An exact net on a surface of revolution.
        inet web --profile vase --theta 75 --theta0 60 -m 24 -o vase.obj
        inet web --profile sphere --theta 60 --theta0 45 -m 36 -n 10 -o web.ply""",
    "cover": """Cover a surface from a file with a net of two given angles.
        inet cover roof --theta 60 --theta0 60 --quads 1500 -o net.obj
        inet cover saddle --theta 90 --theta0 90 --direction 30 -o 'my net.ply' --json""",
    "optimize": """Change a quad mesh into a net with the angles you want.
        inet web --profile vase --theta 75 --theta0 60 -m 24 -n 12 -o vase.obj
        inet optimize vase.obj --theta 80 --theta0 70 --reference vase.obj -o other.obj""",
    "measure": """How well a quad mesh keeps two angles, and its quality.
        inet web --profile vase --theta 75 --theta0 60 -m 24 -o vase.obj
        inet measure vase.obj --theta 75 --theta0 60
        inet measure vase.obj --json --planar-report 0.01""",
    "schedule": """Tables of a net's panels, nodes and bars, for whoever builds it.
        inet web --profile vase --theta 75 --theta0 60 -m 24 -n 12 -o vase.obj
        inet schedule vase.obj -o panels.csv
        inet schedule vase.obj --tolerance 0.02 -o 'alike panels.csv' --json""",
    "course": """Grade the exercises in many notebooks that were handed in.
        inet course grade submissions
        inet course grade submissions -o 'week 2.csv' --seconds 60""",
    "figures": """Rerun the notebooks of a clone and redraw their figures.
        inet figures fig05
        inet figures 3_1 4 --folder .""",
    "completion": """Let the Tab key complete commands, options and names.
        inet completion bash
        inet completion fish""",
}
TEXTS = {name: [*map(str.strip, text.splitlines())] for name, text in HELP.items()}
INSTEAD = {  # options that other programs have
    "--server": "the page is served without a browser anyway, leave it out (--open opens one)",
}


class Parser(argparse.ArgumentParser):
    """A mistake is one sentence on stderr, with no usage text around it."""

    def error(self, message):
        self.exit(WRONG, f"inet: {message} (see {self.prog} --help)\n")


class Overview(Parser):
    """The parser of `inet` itself: its help is sorted by purpose."""

    def format_help(self):
        lines = [ABOUT]
        for purpose, names in PURPOSES.items():
            lines += ["", f"{purpose}:"]
            for name in names.split():
                text, *examples = TEXTS[name]
                own = next(line for line in examples if line.startswith(f"inet {name}"))
                lines += [f"  {name:11}{text}", f"{'':13}{own}"]
        return "\n".join([*lines, "", EPILOG, ""])


def main(arguments: list[str] | None = None) -> int:
    """Run `inet` with these arguments, or those of the process: the exit code, see `EPILOG`."""
    words = joined(sys.argv[1:] if arguments is None else arguments)
    if words[:1] == ["help"]:
        words = [*words[1:], "--help"]
    try:
        top, known = parsers(words)
        misspelt(words, top, known)
        given, more = top.parse_known_args(words or ["--help"])
        if more:
            known[given.command].error(f"{more[0]} is a word too many (quote names with spaces)")
    except SystemExit as end:  # help, the version, or a mistake that was already told
        return end.code
    written = len(files.WRITTEN)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            code = given.run(given)
        sys.stdout.flush()
        return code or DONE
    except KeyboardInterrupt:
        quiet = given.command in ("figures", "explore", "show") or len(files.WRITTEN) > written
        return tell("stopped" + ", nothing was written" * (not quiet), STOPPED)
    except BrokenPipeError:  # the reader of our output went away, for example `head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except (ValueError, OSError, ImportError, RuntimeError, ArithmeticError) as error:
        return tell(error, WRONG)
    except MemoryError:
        return tell("there is not enough memory for this: ask for fewer quads", WRONG)


def joined(words: list[str]) -> list[str]:
    """The words with `--align -1,0,0` as `--align=-1,0,0`: argparse takes -1,0,0 for an option."""
    found: list[str] = []
    for word in words:
        if found and re.match(r"-[\d.]", word) and re.fullmatch(r"--[\w-]+", found[-1]):
            found[-1] += f"={word}"
        else:
            found.append(word)
    return found


def parsers(words: list[str]) -> tuple[Parser, dict[str, Parser]]:
    """The parser of `inet` and those of its commands, by name; only those among the words have
    their options, since these name what there is to choose from."""
    style = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}
    top = Overview(prog="inet", **style)
    top.add_argument("--version", action="version", version=f"inet {__version__}")
    kind = {"dest": "command", "metavar": "COMMAND", "required": True, "parser_class": Parser}
    commands, known = top.add_subparsers(**kind), {}
    for name, (text, *examples) in TEXTS.items():
        epilog = "\n  ".join(["examples:", *examples])
        known[name] = commands.add_parser(name, description=text, epilog=epilog, **style)
        if name in words:
            run, options = COMMANDS[name]
            known[name].set_defaults(run=run)
            options(known[name])
    return top, known


def misspelt(words: list[str], top: Parser, known: dict[str, Parser]) -> None:
    """End with the nearest name where the command or one of its options has another."""
    name, *rest = words if words and not words[0].startswith("-") else ["inet", *words]
    if name != "inet" and name not in known:
        top.error(f"there is no command {name}: {nearest(name, known)}")
    command = known.get(name, top)
    options = completion.options(command)
    for word in rest[: rest.index("--")] if "--" in rest else rest:
        option = word.split("=")[0]
        if re.match(r"-[^\d.]", word) and not {option, word[:2]} & {*options}:
            instead = INSTEAD.get(option) or nearest(option, options)
            command.error(f"{name} has no option {option}: {instead}")


def _completion_options(command):
    command.add_argument(
        "shell",
        choices=completion.SHELLS,
        help='whose script is printed, for eval "$(inet completion bash)"',
    )


def _completion(given):
    print(completion.script(given.shell, parsers([*TEXTS])[1], TEXTS))


COMMANDS = {
    **looks.COMMANDS,
    **nets.COMMANDS,
    **project.COMMANDS,
    "completion": (_completion, _completion_options),
}
