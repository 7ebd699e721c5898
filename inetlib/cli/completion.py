"""Scripts for the Tab key: commands, their options, what an option may be, names of examples.

They are made from the parsers, and files are completed wherever a file may stand."""

import argparse
import shlex

from .options import LOCAL

BASH = """\
# Tab completion of inet.  bash: eval "$(inet completion bash)" in ~/.bashrc
_inet() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words= files=yes
  if [ "$COMP_CWORD" = 1 ]; then words={commands} files=
  else case "${{COMP_WORDS[1]}} $before" in
{values}
    *) case "${{COMP_WORDS[1]}} $word" in
{options}
{names}
    esac ;;
  esac; fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  local IFS=$'\\n'
  if [ "$files" ]; then COMPREPLY+=($(compgen -f -- "$word")); fi
}}
complete -o filenames -F _inet inet"""
ZSH = """\
# Tab completion of inet.  zsh: eval "$(inet completion zsh)" in ~/.zshrc, after compinit
autoload -U +X bashcompinit && bashcompinit
"""
SHELLS = "bash", "zsh", "fish"
FILES = "FILE", "FOLDER", "PROFILE"  # metavars of options where a file may stand


def options(command: argparse.ArgumentParser) -> dict[str, argparse.Action]:
    """The options of a command by their names: {"--theta": ..., "-o": ...}."""
    return {name: action for action in command._actions for name in action.option_strings}


def script(shell: str, known: dict[str, argparse.ArgumentParser], texts: dict[str, list]) -> str:
    """The script of a shell for the parsers of all commands, {name: [what it does, ...]}."""
    return _fish(known, texts) if shell == "fish" else ZSH * (shell == "zsh") + _bash(known)


def _words(action):
    """What may stand for an option or a word: its choices, or names of examples."""
    from ..examples import SURFACES
    from ..surfaces import PROFILES

    known = {"profile": PROFILES, "surface": SURFACES, "host": LOCAL}
    return action.choices or known.get(action.dest, ())


def _bash(known):
    values, flags, names = [], [], []
    for name, command in known.items():
        every = options(command)
        flags.append(_case(f"{name} -", "*", every, files=False))
        for option, action in every.items():
            if action.nargs != 0:  # it takes a value
                files = action.metavar in FILES
                values.append(_case(f"{name} {option}", "", _words(action), files))
        plain = [action for action in command._actions if not action.option_strings]
        if plain and (words := _words(plain[0])):
            names.append(_case(f"{name} ", "*", words, len(plain) > 1 or not plain[0].choices))
    parts = {"values": values, "options": flags, "names": names}
    text = {key: "\n".join(lines) for key, lines in parts.items()}
    return BASH.format(commands=_list([*known, "--help", "--version"]), **text)


def _case(words, more, found, files):
    return f"    {shlex.quote(words)}{more}) words={_list(found)}{' files=' * (not files)} ;;"


def _list(words):
    return shlex.quote(" ".join(words or ()))


def _fish(known, texts):
    lines = ["# Tab completion of inet.  fish: inet completion fish | source, in config.fish"]
    for name, command in known.items():
        lines.append(_line("__fish_use_subcommand", texts[name][0], "f", a=name))
        there = f"__fish_seen_subcommand_from {name}"
        for action in command._actions:
            words, text = _words(action), command._get_formatter()._expand_help(action)
            more = {"a": " ".join(words)} if words else {}
            for option in action.option_strings:
                key = "l" if option.startswith("--") else "s"
                flags = "" if action.nargs == 0 else "r" if action.metavar in FILES else "x"
                lines.append(_line(there, text, flags, **{key: option.lstrip("-")}, **more))
            if words and not action.option_strings:
                lines.append(_line(there, text, "f" if action.choices else "", **more))
    return "\n".join(lines)


def _line(where, text, flags="", **more):
    words = ["complete", "-c", "inet", "-n", where, *(f"-{flag}" for flag in flags)]
    for key, value in more.items():
        words += [f"-{key}", value]
    return shlex.join([*words, "-d", " ".join(text.split())])
