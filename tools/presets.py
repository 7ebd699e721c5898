"""The small pictures of the nets that the explorer begins with: inetlib/explorer/presets/NAME.png.

    python tools/presets.py

Each is drawn as the explorer saves it.  What shows the same as before is kept."""

import io
import sys
from contextlib import suppress

import numpy as np
import PIL.Image

from inetlib import files
from inetlib.drawings import same
from inetlib.explorer import choices, scene, welcome
from inetlib.explorer.session import Session

SIZE, COLOURS = (288, 216), 40


def picture(preset) -> bytes:
    """The PNG of the net of a preset, seen as the explorer does at first."""
    session = Session()
    session.choice, _ = choices.parse(preset.link)
    (session.search(session.begin()) if session.must_search else session.construct())
    sight = np.radians(scene.sight(session.choice.kind, session.V))
    drawn = PIL.Image.open(io.BytesIO(session.save(".png", *sight))).convert("RGB")
    small, out = drawn.resize(SIZE, PIL.Image.Resampling.BOX).quantize(COLOURS), io.BytesIO()
    small.save(out, "png", optimize=True)
    return out.getvalue()


def main() -> int:
    """Draw all of them."""
    for name, preset in welcome.PRESETS.items():
        png, path, alike = picture(preset), welcome.PICTURES / f"{name}.png", False
        with suppress(OSError):
            alike = same.picture(path.read_bytes(), png, *same.FEW)
        if not alike:
            with files.replacing(path) as new:
                new.write_bytes(png)
        print(f"{name:10} {len(png):6} bytes  {'kept' if alike else 'written'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
