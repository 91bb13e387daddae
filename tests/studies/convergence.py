"""Convergence of the thick cylinder: errors in energy and L2 norm over basis, degree, mesh and time."""
import csv
import math
import os
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common

done = subprocess.run([common.build / "tests" / "study_convergence"], capture_output=True, text=True, check=True,
                      env={**os.environ, "BEZEL_SOURCE": str(common.root)})
numbers = "p", "mesh", "dofs", "energy", "l2", "seconds"
runs = [{"case": row["basis"] + row["p"], **{name: float(row[name]) for name in numbers}}
        for row in csv.DictReader(done.stdout.splitlines())]
cases = {}
for run in runs:
    cases.setdefault(run["case"], []).append(run)


def rates(series, norm):
    """Slopes between neighbouring meshes."""
    return [math.log(a[norm] / b[norm]) / math.log(b["mesh"] / a["mesh"]) for a, b in zip(series, series[1:])]


rows = []
for case, series in sorted(cases.items()):
    energy, l2 = ([""] + [f"{rate:.2f}" for rate in rates(series, norm)] for norm in ("energy", "l2"))
    for i, run in enumerate(series):
        rows.append([case, int(run["mesh"]), int(run["dofs"]), f"{run['energy']:.2e}", energy[i],
                     f"{run['l2']:.2e}", l2[i] if run["l2"] > 1e-12 else "rounding", f"{1e3 * run['seconds']:.1f}"])
common.table("convergence", ["basis", "elements per side", "dofs", "energy error", "rate", "L2 error", "rate",
                             "time [ms]"], rows)

chart, panels = plt.subplots(1, 2, figsize=(11, 4.6), sharey=True)
colours = dict(zip(range(1, 6), ["tab:gray", "tab:blue", "tab:orange", "tab:green", "tab:red"]))
for case, series in sorted(cases.items()):
    style = dict(color=colours[int(series[0]["p"])], linestyle="-" if case[0] == "N" else "--",
                 marker="o" if case[0] == "N" else "s", markersize=4, label=case)
    errors = [run["energy"] for run in series]
    panels[0].loglog([run["dofs"] for run in series], errors, **style)
    panels[1].loglog([run["seconds"] for run in series], errors, **style)
panels[0].set_xlabel("dofs")
panels[1].set_xlabel("time of preparation and solution [s]")
panels[0].set_ylabel("relative error in energy norm")
for panel in panels:
    panel.grid(True, which="major", alpha=0.3)
panels[1].legend(ncol=2, fontsize=8)
chart.suptitle("Thick cylinder: NURBS (N) and Lagrange (L), degrees 1 to 5")
chart.tight_layout()
common.figure(plt, "convergence")
