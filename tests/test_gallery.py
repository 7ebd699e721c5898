"""The gallery: its nets by the independent judge, its lines by running them, its files."""

import ast
import inspect
import io
import json

import gallery  # tools/gallery.py
import numpy as np
import PIL.Image
import pytest

from inetlib import measure
from inetlib.drawings import same

pytestmark = pytest.mark.program

ENTRIES = json.loads((gallery.FOLDER / "gallery.json").read_text(encoding="utf-8"))
NAMES = [net.__name__ for net in gallery.NETS]


def made(name):
    """What the stored lines alone make: (V, Q, angles)."""
    room = {}
    exec(f"{ENTRIES[name]['imports']}\n\n{ENTRIES[name]['lines']}", room)
    return room[name]()


def test_there_are_twelve_with_one_picture_and_one_entry_each():
    assert len(NAMES) == 12 and list(ENTRIES) == NAMES
    files = {path.name for path in gallery.FOLDER.iterdir()}
    assert files == {"gallery.json", *(f"{name}.png" for name in NAMES)}
    assert len({entry["title"] for entry in ENTRIES.values()}) == 12


@pytest.mark.parametrize("name", NAMES)
def test_the_stored_lines_make_a_net_with_the_stored_numbers(name):
    entry, net = ENTRIES[name], getattr(gallery, name)
    V, Q, angles = made(name)
    theta, theta0 = measure.angles(V, Q)
    off = np.degrees(max(abs(theta - angles[0]).max(), abs(theta0 - angles[1]).max()))
    quality = measure.quality(V, Q)
    assert entry["flips"] == quality.flips == 0 and entry["darts"] == quality.darts == 0
    assert entry["quads"] == len(Q) and 1000 <= len(Q) <= 4000
    assert entry["deviation_deg"] == pytest.approx(off, abs=2e-7)
    assert [entry["theta_deg"], entry["theta0_deg"]] == pytest.approx(np.degrees(angles), abs=2e-6)
    assert entry["exact"] == (off < 1e-6) and off < 0.5
    assert ("sampled" in entry["sentence"]) != entry["exact"]
    assert same.claims(entry, gallery.facts(net, V, Q, angles))


@pytest.mark.parametrize("name", NAMES)
def test_the_lines_are_few_and_use_public_names(name):
    lines = inspect.getsource(getattr(gallery, name))
    tree = ast.parse(lines)
    assert len(lines.splitlines()) <= 12 and tree.body[0].args.args == []
    sentence = ast.get_docstring(tree.body[0])
    assert sentence.endswith(".") and sentence.count(". ") == 0 and "\n" not in sentence
    used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    used |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    assert not [word for word in used if word.startswith("_") and word != "_"]


def test_the_pictures_are_small_and_nothing_is_cut_off():
    sizes = {name: (gallery.FOLDER / f"{name}.png").stat().st_size for name in NAMES}
    assert max(sizes.values()) <= 150_000 and sum(sizes.values()) <= 1_600_000, sizes
    for name in NAMES:
        image = PIL.Image.open(gallery.FOLDER / f"{name}.png")
        assert image.mode == "P" and image.size == (1080, 1080), name
        inked = np.argwhere(np.asarray(image.convert("L")) < 250)
        (top, left), (bottom, right) = inked.min(axis=0), inked.max(axis=0)
        assert min(top, left, 1079 - bottom, 1079 - right) >= 20, name
        assert max(bottom - top, right - left) >= 980, name
        assert abs((left + right) / 2 - 539.5) < 6 and abs((top + bottom) / 2 - 539.5) < 6, name


def test_redrawn_a_picture_is_kept_and_what_changed_is_written(tmp_path, monkeypatch, capsys):
    stored = (gallery.FOLDER / "roof.png").read_bytes()
    monkeypatch.setattr(gallery, "FOLDER", tmp_path)
    assert gallery.main(["roof"]) == 0 and capsys.readouterr().out.endswith("written\n")
    drawn = (tmp_path / "roof.png").read_bytes()
    assert same.picture(stored, drawn, *same.FEW)
    entry = gallery.read()["roof"]
    assert same.claims(entry, ENTRIES["roof"])
    assert not gallery.save("roof", drawn, entry)
    nearly = entry | {"deviation_deg": entry["deviation_deg"] + 1e-7}
    assert not gallery.save("roof", drawn, nearly) and gallery.read()["roof"] == entry
    assert gallery.save("roof", drawn, entry | {"darts": 1}) and gallery.read()["roof"]["darts"]
    other = PIL.Image.open(io.BytesIO(drawn)).rotate(90)
    other.save(tmp_path / "other.png")
    assert gallery.save("roof", (tmp_path / "other.png").read_bytes(), entry)
    (tmp_path / "gallery.json").write_text("{", encoding="utf-8")
    assert gallery.read() == {} and gallery.save("roof", drawn, entry)
    (tmp_path / "roof.png").write_bytes(drawn[:100])
    assert gallery.save("roof", drawn, entry)
    assert gallery.read() == {"roof": entry} and (tmp_path / "roof.png").read_bytes() == drawn


def test_a_name_that_is_none_is_refused(capsys):
    assert gallery.main(["nothing"]) == 2
    assert "no net ['nothing']: there are vase" in capsys.readouterr().err
