"""The explorer: turn the angles of a net and see it change, in a browser or in JupyterLab.

`session` is one explorer without a page; `scene`, `page`, `app` and `serve` are its page, and
need the packages of the extra `view`."""

__all__ = ["in_the_round", "show", "turn"]


def __getattr__(name):
    """These functions are loaded when they are first used, for `python -m inetlib.explorer`."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import notebook

    return getattr(notebook, name)
