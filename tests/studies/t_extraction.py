"""T-splines: time and memory of refinement and extraction against the number of functions."""
import os
import subprocess

import common

program = common.build / "tests" / "study_t_extraction"


def measured(*arguments):
    """Output and peak memory [MB] of one process."""
    with subprocess.Popen([program, *arguments], stdout=subprocess.PIPE, text=True) as process:
        line = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{program} failed with status {process.returncode}")
    return [float(item) for item in line.split(",")], usage.ru_maxrss / 1024


_, nothing = measured("side", "0")
rows = []
for pattern, finest in ("side", (7, 9, 11, 13)), ("diagonal", (6, 8, 10, 11)):
    for levels in finest:
        (functions, elements, operators, *seconds), memory = measured(pattern, str(levels))
        rows.append([pattern, int(functions), int(elements), int(operators), *(f"{part:.3f}" for part in seconds),
                     f"{sum(seconds):.2f}", f"{1e6 * sum(seconds) / functions:.1f}", f"{memory:.0f}",
                     f"{1024 * (memory - nothing) / functions:.1f}"])
common.table("t_extraction", ["refined along", "functions", "elements", "operators", "refine [s]", "check suitability [s]",
                              "functions, control points [s]", "extract [s]", "all [s]", "us per function",
                              "memory [MB]", "kB per function"], rows)
