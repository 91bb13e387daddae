"""What the studies share: running decks, reading histories, writing tables and figures where the README shows them."""
import csv
import json
import os
import pathlib
import re
import resource
import subprocess
import sys

root = pathlib.Path(os.environ["BEZEL_ROOT"])
build = pathlib.Path(os.environ["BEZEL_BUILD"])
work = build / "studies"
pictures = root / "inputs" / "pictures"
reuse = "--reuse" in sys.argv  # runs that an earlier call of the study has finished are not repeated
if reuse:
    sys.argv.remove("--reuse")


class Run:
    """One run of a deck: exit status, log text, processor seconds, history by column name."""

    def __init__(self, deck, label, **parameters):
        self.folder = work / label
        work.mkdir(parents=True, exist_ok=True)
        arguments = [f"{name}={value}" for name, value in parameters.items()]
        note = work / f"{label}.json"
        if reuse and note.exists():
            self.seconds, self.status, self.log, self.errors = json.loads(note.read_text())
        else:
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            done = subprocess.run([build / "bezel", root / deck, *arguments, "--out", self.folder],
                                  capture_output=True, text=True, cwd=work)
            # processor time: what else runs on the machine disturbs it little
            self.seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            self.status, self.log, self.errors = done.returncode, done.stdout, done.stderr
            note.write_text(json.dumps([self.seconds, self.status, self.log, self.errors]))
        self.history = history(self.folder / "history.csv") if (self.folder / "history.csv").exists() else {}

    def share(self, phase):
        """Seconds that the log gives to a phase of the run (elements, factorise, ...)."""
        found = re.search(rf"^  {phase} +([0-9.]+) s", self.log, re.M)
        return float(found.group(1)) if found else 0.0

    @property
    def iterations(self):
        return sum(self.history["iterations"])


def check(deck, **parameters):
    """What --check prints of a deck."""
    arguments = [f"{name}={value}" for name, value in parameters.items()]
    return subprocess.run([build / "bezel", root / deck, *arguments, "--check"], capture_output=True, text=True,
                          check=True).stdout


def history(path):
    """Columns of a history.csv as lists of floats."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]} if rows else {}


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(item) for item in row) + " |" for row in rows]
    return "\n".join(lines)


def table(name, header, rows):
    """Put a table between the README's marks `<!-- table NAME -->` and `<!-- end -->`, and print it."""
    text = markdown(header, rows)
    print(text, flush=True)
    place(name, text)


def place(name, text):
    """Put text between the README's marks of a name."""
    readme = root / "README.md"
    old = readme.read_text() if readme.exists() else ""
    marks = re.compile(rf"(<!-- table {re.escape(name)} -->\n).*?(<!-- end -->)", re.S)
    if marks.search(old):
        readme.write_text(marks.sub(lambda m: m.group(1) + text + "\n" + m.group(2), old))
    else:
        print(f"(README.md has no mark for table {name})")


def figure(plot, name):
    """Save a figure beside the decks."""
    pictures.mkdir(exist_ok=True)
    plot.savefig(pictures / f"{name}.png", dpi=110)
    print(f"figure {pictures / name}.png", flush=True)


def mesh_picture(label, name, field, step):
    """The deformed mesh of a run at a step, drawn by driver/plot, beside the decks."""
    folder = work / label
    before = set(folder.glob("*.png"))
    subprocess.run([root / "driver" / "plot", folder, "--no-history", "--field", field, "--step", str(step), "--dpi", "110"],
                   check=True, capture_output=True)
    made = sorted(set(folder.glob("*.png")) - before)
    pictures.mkdir(exist_ok=True)
    made[0].rename(pictures / f"{name}.png")
    print(f"figure {pictures / name}.png", flush=True)
