"""Walk through the lectures with a clock: run what each part shows, in order, and say how long.

    python tools/walk.py               both plans of book/, each lecture with fresh kernels
    python tools/walk.py lectures_two  one of them

A part names headings of notebooks.  The cells under them are run after all cells before them;
what a notebook has run in its lecture is not run again.  Exit code 1 when a cell fails, or when
the cells of a part take longer than its minutes."""

import re
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "book"))
import wording  # noqa: E402

PLANS = "lectures_two", "lectures_six"
LINK = re.compile(r"notebooks/(\w+)\.ipynb#((?:[^()\s]|\([^()\s]*\))+)")
PART = re.compile(r"(?:### |\| )(\d+) to (\d+)\b(?:\:| \|)? *([^\n|]*)")


def parts(plan):
    """[(lecture, from, to, title, [(notebook, heading), ...])] of all parts of a plan."""
    text = (ROOT / "book" / f"{plan}.md").read_text(encoding="utf-8")
    found = []
    for lecture in re.split(r"(?m)^## ", text)[1:]:
        for part in re.split(r"(?m)^(?=### \d|\| \d)", lecture)[1:]:
            start, stop, title = PART.match(part).groups()
            head = lecture.partition("\n")[0]
            found.append((head, int(start), int(stop), title.strip(), LINK.findall(part)))
    return found


class Opened:
    """A notebook with its kernel, and how many of its cells have been run."""

    def __init__(self, stem):
        import nbformat
        from nbclient import NotebookClient

        self.book = nbformat.read(ROOT / "notebooks" / f"{stem}.ipynb", as_version=4)
        place = {"metadata": {"path": str(ROOT / "notebooks")}}
        self.client = NotebookClient(self.book, timeout=600, resources=place)
        self.open, self.done, self.ends, here = self.client.setup_kernel(), 0, {}, []
        self.open.__enter__()
        for k, cell in enumerate(self.book.cells):
            lines = cell.source.splitlines() if cell.cell_type == "markdown" else []
            heads = [wording.slug(x.lstrip("# ")) for x in lines if re.match(r"#{1,4} ", x)]
            here = heads or here
            self.ends |= dict.fromkeys(here, k + 1)

    def run_to(self, heading):
        """Run the cells up to the last one under a heading."""
        for k in range(self.done, self.ends[heading]):
            if self.book.cells[k].cell_type == "code":
                self.client.execute_cell(self.book.cells[k], k)
        self.done = max(self.done, self.ends[heading])


def main(plans):
    """Exit code 0 when every cell ran in its time."""
    from nbclient.exceptions import CellExecutionError

    late, before, opened = 0, None, {}
    if wrong := set(plans) - set(PLANS):
        print(f"no plan is called {sorted(wrong)[0]!r}: {' or '.join(PLANS)}", file=sys.stderr)
        return 2
    for plan in plans or PLANS:
        for lecture, start, stop, title, shown in parts(plan):
            if lecture != before:
                close(opened)
                print(f"\n{lecture}\n  min      s  shown")
            before, begun = lecture, time.perf_counter()
            for stem, heading in shown:
                if stem not in opened:
                    opened[stem] = Opened(stem)
                try:
                    opened[stem].run_to(heading)
                except (CellExecutionError, KeyError) as error:
                    print(f"{stem}, {heading}: {str(error).strip().splitlines()[-1]}")
                    late += 1
            seconds = time.perf_counter() - begun
            late += seconds > 60 * (stop - start)
            mark = "  LATE" if seconds > 60 * (stop - start) else ""
            print(f"{start:3} {stop:2} {seconds:6.1f}  {len(shown)}  {title}{mark}", flush=True)
    close(opened)
    return min(late, 1)


def close(opened):
    """End all kernels."""
    while opened:
        opened.popitem()[1].open.__exit__(None, None, None)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
