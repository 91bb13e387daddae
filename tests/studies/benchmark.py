"""What the parts of the program and whole runs cost (the same as tests/benchmark)."""
import os
import re
import subprocess

import common

tables = []
program = common.build / "tests" / "benchmark"


def measured():
    """Tables of the Fortran program: {group: {row: {column: value}}}, in its order."""
    scratch = common.work / "benchmark"
    scratch.mkdir(parents=True, exist_ok=True)
    groups = {}
    with subprocess.Popen([program, common.root, scratch], stdout=subprocess.PIPE, text=True) as run:
        for line in run.stdout:
            group, row, column, value = line.split("|")
            groups.setdefault(group, {}).setdefault(row, {})[column] = float(value)
    if run.returncode != 0:
        raise SystemExit(f"{program} failed with status {run.returncode}")
    return groups


def number(value):
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def show(title, rows):
    """Print a table, its title in the corner, and keep it for the README."""
    columns = list(dict.fromkeys(column for row in rows.values() for column in row))
    cells = [[row, *(number(values[column]) if column in values else "" for column in columns)]
             for row, values in rows.items()]
    tables.append(common.markdown([title, *columns], cells))
    print(tables[-1], end="\n\n", flush=True)


def run(deck, label, **parameters):
    """CPU seconds, peak memory [MB] and log of one run."""
    folder = common.work / label
    arguments = [f"{name}={value}" for name, value in parameters.items()]
    with subprocess.Popen([common.build / "bezel", common.root / deck, *arguments, "--out", folder],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=common.work) as process:
        log = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(log)
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, log


def phases(log):
    """{phase: seconds} and the total from the end of a log."""
    total = float(re.search(r"^total +([0-9.]+) s", log, re.M).group(1))
    found = {name: float(seconds) for name, seconds in re.findall(r"^  (\w+) +([0-9.]+) s +[0-9.]+ %", log, re.M)}
    return found, total


def iterations(log):
    return int(re.search(r"^total .* s, (\d+) iterations", log, re.M).group(1))


def ironing():
    """Shares of the phases, time of an iteration, growth with mesh and Gauss points."""
    aims = {1: 6, 2: 25, 3: 110}
    shares, costs = {}, {}
    for mesh, gp in [(1, 2), (2, 2), (3, 2), (2, 4), (2, 8)]:
        best = None
        for _ in range(2):
            cpu, memory, log = run("inputs/ironing.inp", "benchmark_ironing", basis="N", mesh=mesh, gp=gp, last=60)
            if best is None or cpu < best[0]:
                best = cpu, memory, log
        cpu, memory, log = best
        seconds, total = phases(log)
        name = f"mesh {mesh}, gp = {gp}"
        shares[name] = {f"{phase} [%]": 100 * time / total for phase, time in seconds.items() if phase != "other"}
        shares[name]["search and contact [%]"] = 100 * (seconds["search"] + seconds["contact"]) / total
        costs[name] = {"equations": float(re.search(r"^(\d+) equations", log, re.M).group(1)),
                       "interface points": float(re.search(r"(\d+) interface points", log).group(1)),
                       "iterations": iterations(log), "CPU time [s]": cpu,
                       "an iteration [ms]": 1e3 * cpu / iterations(log), "aim [ms]": aims[mesh],
                       "peak memory [MB]": memory}
    show("ironing N3, 60 steps", shares)
    show("ironing N3, 60 steps", costs)


def scenes():
    """A linear block has no interface: phases that do not occur, and memory."""
    rows = {}
    for n in [20, 200]:
        cpu, memory, log = run("inputs/block.inp", "benchmark_block", n=n, p=2)
        seconds, _ = phases(log)
        absent = [phase for phase in ("search", "contact") if phase in seconds]
        rows[f"block, {n} x {n} elements, p = 2"] = {"CPU time [s]": cpu, "peak memory [MB]": memory,
                                                    "interface phases": len(absent)}
    show("linear, no interface", rows)


groups = measured()
for group, title in [("element", "one solid element"), ("shell element", "one shell element"),
                     ("adapter", "one solid element"), ("shape functions", "functions at a point"),
                     ("interface point", "one interface point"), ("search", "master surface"),
                     ("system", "ironing N3")]:
    show(title, groups[group])
ironing()
scenes()
common.place("benchmark", "\n\n".join(tables))
