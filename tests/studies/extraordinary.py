"""Extraordinary points: approximation, smoothness, cost; error against time beside multi-patch meshes; whole runs."""
import csv
import math
import os
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common

polygons = {3: "triangle", 4: "square (regular)", 5: "pentagon", 6: "hexagon", 7: "heptagon", 8: "octagon"}
others = {"half_star": "half of a polygon about a point on the boundary", "l_shape": "L of three squares (inward corner)",
          "cap": "cap, four points whose seams cross", "patchwork": "patchwork (square of random triangles, three faces each)",
          "framed": "patchwork in a regular frame"}


def name_of(mesh, faces):
    """A mesh of the study's program in words."""
    if mesh == "star":
        return polygons[faces]
    if mesh == "short_star":
        return f"{polygons[faces]}, short seams"
    return others[mesh]


def lines(program, *arguments):
    """The comma-separated blocks that a program of the studies writes; its processor time [s] and peak memory [MB]."""
    process = subprocess.Popen([common.build / "tests" / program, *arguments], stdout=subprocess.PIPE, text=True)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{program} {' '.join(arguments)}: exit status {process.returncode}")
    return list(csv.DictReader(text.splitlines())), usage.ru_utime, usage.ru_maxrss / 1024


def approximation():
    """Best approximation with free edges, clamped plates, constant curvature: errors from mesh to mesh, rate on the last two."""
    found, _, _ = lines("study_extraordinary", "bending")
    for problem in ["free", "clamped", "curvature"]:
        groups = {}
        for row in found:
            if row["problem"] == problem:
                groups.setdefault((row["mesh"], int(row["faces"])), []).append(row)
        rows = []
        for (mesh, faces), runs in groups.items():
            last = runs[-3:]
            rate = [math.log2(float(last[-2][norm]) / float(last[-1][norm])) for norm in ["h2", "l2"]]
            exact = max(float(run["h2"]) for run in last) < 1e-9
            rows.append([name_of(mesh, faces), faces, ", ".join(run["dofs"] for run in last),
                         ", ".join(f"{float(run['h2']):.1e}" for run in last),
                         ", ".join(f"{float(run['l2']):.1e}" for run in last),
                         "exact" if exact else f"{rate[0]:.2f}, {rate[1]:.2f}"])
        common.table(f"extraordinary_{problem}", ["mesh", "faces at a point, at most", "unknowns", "H2", "L2", "rates H2, L2"], rows)


def smoothness():
    found, _, _ = lines("study_extraordinary", "smoothness")
    rows = [[row["surface"].replace("_", " "), row["faces"], row["points"], f"{float(row['gap']):.0e}",
             f"{float(row['turn']):.0e}", f"{float(row['sums']):.0e}"] for row in found]
    common.table("extraordinary_smoothness", ["surface", "faces at a vertex, at most", "control points", "largest gap",
                                               "largest turn of the normal [rad]", "functions' sum - 1"], rows)


def extraction():
    """Closed cubes with eight points of valence 3; time and peak are those of the whole process, the control mesh among it."""
    rows = []
    first = None
    _, _, least = lines("study_extraordinary", "extraction", "0")  # what starting a process takes: less cannot be told
    for levels in range(4, 7):
        tries = [lines("study_extraordinary", "extraction", str(levels)) for _ in range(3)]
        best = min(seconds for _, seconds, _ in tries)
        (row,), _, peak = tries[0]
        elements = int(row["elements"])
        each = 1e6 * best / elements
        first = first or each
        rows.append([elements, row["points"], f"{best:.3f}", f"{each:.1f}", f"{each / first:.2f}",
                     f"{int(row['bytes']) / 1e6:.2f}", f"{peak:.0f}" if peak > 1.2 * least else f"< {1.2 * least:.0f}"])
    common.table("extraordinary_extraction", ["elements", "control points", "processor time [s]", "per element [us]", "over the first",
                                               "operators [MB]", "peak of the process [MB]"], rows)


def elements():
    """Shell elements by their number of functions; ratios to the regular one of 16."""
    found, _, _ = lines("study_extraordinary_elements")
    best = {}
    where = {}
    for row in found:
        key = int(row["functions"]), int(row["degree"])
        where.setdefault(key, {})[row["mesh"]] = int(row["elements"])
        new = [float(row[name]) for name in ["preparation", "residual", "tangent"]]
        best[key] = [min(old, one) for old, one in zip(best.get(key, new), new)]
    regular = best[16, 3]
    rows = []
    for key in sorted(best, key=lambda key: (key[1], key[0])):
        count = [where[key].get(mesh, 0) for mesh in ["triangle", "pentagon", "octagon", "cube"]]
        if not any(count):
            continue
        rows.append([key[0], key[1], *count, *(f"{value:.1f}" for value in best[key]),
                     ", ".join(f"{value / one:.2f}" for value, one in zip(best[key], regular))])
    common.table("extraordinary_elements", ["functions", "degree", "of 192 (triangle)", "of 320 (pentagon)", "of 512 (octagon)",
                                             "of 384 (cube)", "preparation [us]", "residual [us]", "tangent [us]", "over 16 functions"], rows)


# Error against time. Each problem: deck, fixed parameters, its reference, degrees of the patches.
problems = {
    "triangle, one side clamped": ("polygon_plate", {"corners": 3, "hold": "one"}, [2, 3, 4, 5]),
    "pentagon, clamped, pressure": ("polygon_plate", {"corners": 5, "hold": "all"}, [2, 3, 4, 5]),
    "pinched hemisphere": ("sphere_octant", {"load": "point"}, [4, 5]),
    "sphere under pressure": ("sphere_octant", {"load": "pressure"}, [4, 5]),
}
divisions = [4, 8, 16, 32]
stiffnesses = [1000, 100000]


def energy(deck, **parameters):
    """Stored energy, least processor time of three runs."""
    tries = []
    label = "_".join(["extraordinary", deck, *(str(value) for value in parameters.values())])
    for attempt in range(3):
        run = common.Run(f"inputs/verify/{deck}.inp", f"{label}_{attempt}", **parameters)
        if run.status:
            raise SystemExit(f"{deck} {parameters}: {run.errors or run.log}")
        tries.append(run.seconds)
        if run.seconds > 0.3:
            break
    return run.history["elastic"][-1], min(tries)


def reference(deck, fixed):
    """Joints of two stiffnesses, degree 6, extrapolated to rigid ones (their error falls as 1/stiffness); for the pinched
    hemisphere one patch with a pole."""
    if fixed.get("load") == "point":
        return energy("pinched_hemisphere", p=6, n=40)[0]
    soft, hard = (energy(deck, basis="N", p=6, n=12, stiff=stiff, **fixed)[0]
                  for stiff in (1e4, 1e6))
    return hard + (hard - soft) / 99


def trade():
    rows = []
    figure, panels = plt.subplots(2, 2, figsize=(11, 8.5))
    for panel, (name, (deck, fixed, degrees)) in zip(panels.flat, problems.items()):
        exact = reference(deck, fixed)
        fine = [energy(deck, basis="E", level=level, **fixed)[0] for level in (4, 5)]
        limit = fine[1] + (fine[1] - fine[0]) / 15
        print(f"{name}: reference {exact:.10e}, extrapolated from the smooth mesh {limit:.10e} ({limit / exact - 1:.1e})")
        series = [("one mesh, p = 3", [dict(basis="E", level=n.bit_length() - 1) for n in divisions], "k-o")]
        if deck == "sphere_octant":
            series += [(f"patches, p = 3, {stiff}", [dict(basis="C", level=n.bit_length() - 1, stiff=stiff) for n in divisions],
                        "C1" + style) for stiff, style in zip(stiffnesses, ["--s", "-s"])]
        series += [(f"patches, p = {p}, {stiff}", [dict(basis="N", p=p, n=n, stiff=stiff) for n in divisions if p < 4 or n < 32],
                    f"C{p - 2}" + style) for p in degrees for stiff, style in zip(stiffnesses, ["--s", "-s"])]
        for label, parameters, style in series:
            runs = [energy(deck, **fixed, **one) for one in parameters]
            errors = [abs(value / exact - 1) for value, _ in runs]
            panel.loglog([seconds for _, seconds in runs], errors, style, label=label, markersize=4)
            cells = [f"{error:.1e}, {seconds:.2f} s" for error, (_, seconds) in zip(errors, runs)]
            rows.append([name, label, *cells, *[""] * (len(divisions) - len(cells))])
        panel.set(title=name, xlabel="processor time of the run [s]", ylabel="relative error of the energy")
        panel.legend(fontsize=7)
    figure.tight_layout()
    common.figure(figure, "extraordinary_trade")
    common.table("extraordinary_trade", ["problem", "mesh, stiffness of joints", *(f"{n} x {n} a face" for n in divisions)], rows)


phases = ["input", "prepare", "elements", "loads", "search", "contact", "pattern", "analyse", "factorise", "solve", "output",
          "other"]
wholes = {  # name: deck, parameters
    "triangular plate, linear": ("inputs/verify/triangle_plate.inp", {"n": 5}),
    "pinched octant, linear, fitted": ("inputs/verify/sphere_octant.inp", {"level": 4}),
    "hemispheres, contact, 8 steps": ("inputs/hemispheres.inp", {"n": 2, "last": 8}),
    "triangular laminae, debonding, 10 steps": ("inputs/peel_triangle.inp", {"n": 2, "last": 10}),
    "swept pentagon, solid": ("inputs/verify/swept_polygon.inp", {"level": 3}),
}


def shares():
    rows = []
    for number, (name, (deck, parameters)) in enumerate(wholes.items()):
        run = common.Run(deck, f"extraordinary_whole_{number}", **parameters)
        if run.status:
            raise SystemExit(f"{deck} {parameters}: {run.errors or run.log}")
        seconds = {phase: run.share(phase) for phase in phases}
        total = sum(seconds.values())
        equations = next(word for word in run.log.splitlines() if "equations" in word).split()[0]
        part = {"input": ["input"], "prepare": ["prepare"], "elements": ["elements"], "contact": ["search", "contact"],
                "solver": ["pattern", "analyse", "factorise", "solve"], "output": ["output"]}
        rows.append([name, equations, int(run.iterations), f"{run.seconds:.2f}",
                     *(f"{100 * sum(seconds[phase] for phase in members) / total:.0f}" for members in part.values())])
    common.table("extraordinary_shares", ["run", "equations", "iterations", "CPU time [s]", "input and mesh [%]",
                                           "preparation [%]", "elements [%]", "contact [%]", "solver [%]", "output [%]"], rows)


parts = {"approximation": approximation, "smoothness": smoothness, "extraction": extraction, "elements": elements,
         "trade": trade, "shares": shares}
for name in sys.argv[1:] or parts:
    parts[name]()
