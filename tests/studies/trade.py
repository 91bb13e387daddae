"""Speed against accuracy on the ironing problem: basis, order, mesh, Gauss points and penalty, each with its error and time."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import common
from ironing_measures import Slide, dofs

# the reference: the finest smooth mesh, with enough points and a stiff penalty
reference = common.Run("inputs/ironing.inp", "trade_reference", basis="N", p=3, mesh=3, gp=6, penalty=1e4)
press_reference = reference.history["top_ry"][19]

cases = [dict(basis=b[0], p=int(b[1]), mesh=m, gp=2, penalty=1e3)
         for b in ("L1", "L2", "N2", "N3", "N4", "T3") for m in (1, 2)]
cases += [dict(basis="N", p=3, mesh=1, gp=gp, penalty=1e3) for gp in (1, 3, 4, 6, 8)]
cases += [dict(basis="N", p=3, mesh=1, gp=4, penalty=penalty) for penalty in (1e1, 1e2, 1e4, 1e5, 1e6)]

rows, points = [], []
for case in cases:
    label = "trade_{basis}{p}_{mesh}_{gp}_{penalty:g}".format(**case)
    run = common.Run("inputs/ironing.inp", label, **case)
    n = dofs(common.check("inputs/ironing.inp", **case))
    name = f"{case['basis']}{case['p']}"
    if run.status != 0:
        steps = int(max(run.history.get("step", [0])))
        rows.append([name, n, case["gp"], f"{case['penalty']:g}", f"fails at step {steps}", "", "", "", "", ""])
        continue
    slide = Slide(run)
    error = abs(run.history["top_ry"][19] / press_reference - 1)
    rows.append([name, n, case["gp"], f"{case['penalty']:g}", f"{100 * error:.3f} %", f"{slide.smooth[0]:.2e}",
                 f"{slide.smooth[1]:.2e}", f"{slide.penetration:.1e}", int(run.iterations), f"{run.seconds:.1f}"])
    points.append((name, case, run.seconds, slide.smooth[0]))
    print(rows[-1], flush=True)

common.table("trade", ["basis", "dofs", "Gauss points", "penalty", "press-in force error", "oscillation Py",
                       "oscillation Px", "penetration", "iterations", "time [s]"], rows)

figure, axes = plt.subplots(figsize=(6.5, 4.5))
for name, colour in zip(("L1", "L2", "N2", "N3", "N4", "T3"),
                        ("#bbbbbb", "#e0a030", "#80b0e0", "#3070c0", "#103080", "#10a040")):
    mine = [p for p in points if p[0] == name and p[1]["gp"] == 2 and p[1]["penalty"] == 1e3]
    axes.loglog([p[2] for p in mine], [p[3] for p in mine], "o-", color=colour, label=name)
others = [p for p in points if p[1]["gp"] != 2 or p[1]["penalty"] != 1e3]
axes.loglog([p[2] for p in others], [p[3] for p in others], "x", color="#3070c0", label="N3, other points or penalty")
axes.set(xlabel="run time [s]", ylabel="oscillation of Py, detrended", title="ironing: error against time")
axes.legend(fontsize=8)
figure.tight_layout()
common.figure(figure, "trade")
