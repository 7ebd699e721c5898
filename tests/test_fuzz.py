"""Broken files: thousands of mutations, each read rightly or refused in one sentence."""

import random
import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from inetlib import io, mesh

pytestmark = pytest.mark.program

pytest.importorskip("resource", reason="limits of memory need a Unix")
FUZZING = Path(__file__).with_name("fuzzing.py")
NUMBERS = b"-1", b"0", b"nan", b"1e999", b"99999999999999999999", b"0.5", b"", b"3000000000", b"x"


def originals(folder):
    """A file of each kind that is read, as bytes by suffix; several of a suffix in a list."""
    V = np.array([[i, j, 0.1 * i * j] for i in range(4) for j in range(3)], dtype=float)
    Q = mesh.grid_quads(3, 2)
    found = {}
    for suffix in io.READERS:
        path = folder / f"net{suffix}"
        if suffix in io.WRITERS and not io.missing(suffix):
            io.write(path, V, Q, curves="all" if suffix in io.WITH_CURVES else None)
            found[suffix] = [path.read_bytes()]
    corners = V[mesh.triangles(V, Q)[1]]
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*point) for point in triangle)
        + "endloop\nendfacet\n"
        for triangle in corners
    )
    records = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")])
    records["p"] = corners
    binary = bytes(80) + np.uint32(len(corners)).tobytes() + records.tobytes()
    found[".stl"] = [f"solid net\n{facets}endsolid net\n".encode(), binary]
    rows = ["ply", "format ascii 1.0", f"element vertex {len(V)}"]
    rows += [f"property double {x}" for x in "xyz"] + [f"element face {len(Q)}"]
    rows += ["property list uchar int vertex_indices", "end_header"]
    rows += [" ".join(map(repr, point)) for point in V.tolist()]
    rows += [" ".join(map(str, [4, *face])) for face in Q.tolist()]
    found[".ply"].append("\n".join(rows).encode())
    return found


def mutated(data, chance):
    """The bytes with one to four changes: bits, numbers, pieces cut, doubled, moved or swapped."""
    for _ in range(chance.randint(1, 4)):
        a, b = sorted(chance.randrange(len(data) + 1) for _ in range(2))
        kind = chance.randrange(6)
        if kind == 0 and a < len(data):
            data = data[:a] + bytes([data[a] ^ 1 << chance.randrange(8)]) + data[a + 1 :]
        elif kind == 1:
            data = data[:a]
        elif kind == 2:
            data = data[:b] + data[a:b] + data[b:] if b - a < 10_000 else data
        elif kind == 3:
            data = data[:a] + data[b:]
        elif kind == 4:
            data = data[:a] + bytes(chance.randrange(256) for _ in range(4)) + data[a + 4 :]
        elif found := list(re.finditer(rb"-?\d+(\.\d+)?(e[-+]?\d+)?", data)):
            at = chance.choice(found)
            data = data[: at.start()] + chance.choice(NUMBERS) + data[at.end() :]
        data = data or b" "
    return data


def outcomes(paths):
    """{path: outcome} of many files, by processes that are started again where one ends."""
    found, left = {}, [str(path) for path in paths]
    while left:
        command = [sys.executable, FUZZING, *left]
        done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        lines = done.stdout.splitlines()
        found |= dict(zip(lines[::2], lines[1::2], strict=False))
        if len(lines) % 2:
            found[lines[-1]] = f"wrong: the process ended with {done.returncode}"
        assert lines, done.stderr
        left = left[len(lines[::2]) :]
    return found


def read_all(folder, each, slow, seed):
    """The outcomes of so many mutations of each original, of few where another process reads.

    The originals themselves are read."""
    chance, paths, whole = random.Random(seed), [], []
    for suffix, kinds in originals(folder).items():
        for kind, data in enumerate(kinds):
            whole.append(folder / f"{kind}{suffix}")
            whole[-1].write_bytes(data)
            for number in range(slow if suffix in (".vtp", ".3dm") else each):
                path = folder / f"{kind}_{number}{suffix}"
                path.write_bytes(mutated(data, chance))
                paths.append(path)
    found = outcomes(whole + paths)
    assert {found.pop(str(path)) for path in whole} == {"read"} and len(whole) >= 7
    print(len(found), Counter(text.split(":")[0] for text in found.values()))
    return found


def wrong(found):
    return {Path(path).name: text for path, text in found.items() if text.startswith("wrong")}


def test_originals_are_read_and_mutated_files_rightly_or_refused(tmp_path):
    found = read_all(tmp_path, 30, 3, seed=1)
    assert not wrong(found) and {"read", "refused"} <= set(found.values())


@pytest.mark.long
def test_two_thousand_mutated_files_are_read_rightly_or_refused(tmp_path):
    found = read_all(tmp_path, 275, 90, seed=2)
    assert len(found) >= 2000 and not wrong(found)


def killed(folder, number, longest, chance=None):
    """Write a web over an old file, killed at a random moment; the bytes that are there after."""
    path = folder / f"web{number}.obj"
    path.write_bytes(b"old")
    command = [
        sys.executable,
        "-c",
        "from inetlib.start import main; main()",
        "web",
        "--profile",
        "sphere",
        "-m",
        "120",
    ]
    command += ["--theta", "60", "--theta0", "60", "--force", "-o", str(path)]
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        running.wait(chance.uniform(0, longest) if chance else longest)
    except subprocess.TimeoutExpired:
        running.kill()
        running.wait()
    return path.read_bytes()


@pytest.mark.parametrize("count", [6, pytest.param(50, marks=pytest.mark.long)])
def test_kills_at_random_moments_leave_no_half_file(tmp_path, count):
    start = time.perf_counter()
    whole = killed(tmp_path, -1, 60)
    longest, chance = time.perf_counter() - start, random.Random(count)
    found = Counter(killed(tmp_path, number, longest, chance) for number in range(count))
    print({len(data): often for data, often in found.items()})
    assert len(whole) > 100_000 and set(found) <= {b"old", whole} and found[b"old"]
