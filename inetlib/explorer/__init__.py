"""The explorer: turn the angles of a net and see it change, in a browser or in JupyterLab.

`choices` knows what can be asked for, `nets` makes it, `session` is one explorer without a
page, `look` and `plates` say how things are drawn; `scene`, `page`, `app` and `serve` are its
page, and need the packages of the extra `view`.

Paper: Sec. 3-6 (explorer; beyond the paper).
"""

from .notebook import person as person
from .notebook import show as show
from .notebook import show_net as show_net
from .notebook import still as still
