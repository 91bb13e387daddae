"""T-splines on a local feature: energy error of a plate with singular corners, against uniform and graded NURBS."""
import math
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common

deck = "inputs/verify/corners_t.inp"


def solve(case, **parameters):
    run = common.Run(deck, "t_local_" + case, **parameters)
    if run.status != 0:
        raise SystemExit(run.errors or run.log)
    dofs = int(re.search(r"^dofs +(\d+)", common.check(deck, **parameters), re.M).group(1))
    return {"dofs": dofs, "energy": run.history["elastic"][-1], "seconds": run.seconds, **parameters}


# T: the smooth part's error falls as h^3, that of the smallest square about a corner as (2.5^-levels)^0.71
meshes = {
    "N3 uniform": [solve("N", basis="N", n=n) for n in (4, 8, 16, 32, 64, 128)],
    "T3": [solve("T", basis="T", n=n, levels=round(3.2 * math.log2(n))) for n in (4, 6, 8, 12, 16, 24, 32)],
}
# its own error is 2e-6
exact = solve("reference", basis="T", n=64, levels=20, reach=0.5)["energy"]


def error(run):
    """In the energy norm, relative: the load is given, so that the energy is too small by half its square."""
    return math.sqrt(max(exact - run["energy"], 0) / exact)


# graded tensor products: the best of several gradings
meshes["N3 graded"] = [min((solve("G", basis="G", n=n, grade=grade) for grade in (3, 10, 30, 100, 300, 1000, 3000, 10000)),
                           key=error) for n in (8, 16, 32, 64)]


def at_dofs(series, dofs):
    """Error of a series at some dofs, between its meshes, or beyond the last at the rate of the last two."""
    for a, b in zip(series, series[1:]):
        if dofs <= b["dofs"] or b is series[-1]:
            slope = math.log(error(b) / error(a)) / math.log(b["dofs"] / a["dofs"])
            return error(a) * (dofs / a["dofs"])**slope


rows = []
for name in "N3 uniform", "N3 graded", "T3":
    for run in meshes[name]:
        mesh = f"{run['n']} x {run['n']}"
        if "levels" in run:
            mesh += f", {run['levels']} levels"
        if "grade" in run:
            mesh += f", 1 : {run['grade']}"
        others = [f"{at_dofs(meshes[other], run['dofs']) / error(run):.1f}" if name == "T3" else ""
                  for other in ("N3 uniform", "N3 graded")]
        rows.append([name, mesh, run["dofs"], f"{run['energy']:.9f}", f"{error(run):.2e}", *others, f"{1e3 * run['seconds']:.0f}"])
common.table("t_local", ["basis", "elements", "dofs", "elastic energy", "energy error", "uniform N3 at equal dofs is worse by",
                         "graded N3", "time of the run [ms]"], rows)

chart, panel = plt.subplots(figsize=(6.4, 4.6))
for name, style in (("N3 uniform", "o-"), ("N3 graded", "s--"), ("T3", "^-")):
    panel.loglog([run["dofs"] for run in meshes[name]], [error(run) for run in meshes[name]], style, label=name)
panel.set_xlabel("dofs")
panel.set_ylabel("relative error in energy norm")
panel.grid(True, which="major", alpha=0.3)
panel.legend()
panel.set_title("Clamped plate with two singular corners")
chart.tight_layout()
common.figure(plt, "t_local")
