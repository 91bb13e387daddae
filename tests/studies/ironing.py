"""The ironing problem: oscillation of the reactions over basis, order and mesh, cost against accuracy [bases=L1,N3 meshes=1,2,3]."""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common
from ironing_measures import Slide, dofs

every = ["L1", "L2", "L3", "L4", "N2", "N3", "N4", "T3"]
bases = every
meshes = [1, 2, 3]
for argument in sys.argv[1:]:
    name, value = argument.split("=")
    if name == "bases":
        bases = value.split(",")
    elif name == "meshes":
        meshes = [int(item) for item in value.split(",")]
    else:
        sys.exit(f"unknown argument {argument}; known: bases=, meshes=")
partial = bases != every or meshes != [1, 2, 3]


rows, slides = [], {}
for basis in bases:
    for mesh in meshes:
        label = f"ironing_{basis}_{mesh}"
        run = common.Run("inputs/ironing.inp", label, basis=basis[0], p=basis[1], mesh=mesh)
        n = dofs(common.check("inputs/ironing.inp", basis=basis[0], p=basis[1], mesh=mesh))
        steps = int(max(run.history.get("step", [0])))
        if steps < 40:
            rows.append([basis, mesh, n, f"stops at step {steps}"] + [""] * 9)
            continue
        slide = Slide(run)
        slides[basis, mesh] = n, slide, run
        if not slide.whole:  # its oscillation is that of another way: not comparable
            rows.append([basis, mesh, n, f"stops at step {steps}", "", "", "", "", "", int(run.iterations),
                         int(sum(run.history["cutbacks"])), "", ""])
            continue
        rows.append([
            basis, mesh, n, "" if run.status == 0 else f"stops at step {steps}",
            f"{slide.raw[0]:.2e}", f"{slide.raw[1]:.2e}", f"{slide.smooth[0]:.2e}", f"{slide.smooth[1]:.2e}",
            f"{slide.symmetry[0]:.0e} / {slide.symmetry[1]:.0e}" if slide.whole else "",
            int(run.iterations), int(sum(run.history["cutbacks"])),
            f"{run.seconds:.1f}", f"{1e3 * run.seconds / run.iterations:.1f}"])
        print(rows[-1], flush=True)

header = ["basis", "mesh", "dofs", "end", "raw Py", "raw Px", "detrended Py", "detrended Px", "symmetry Py / Px",
          "iterations", "cut-backs", "time [s]", "per iteration [ms]"]
if partial:
    print(*header, sep="\t")
    for row in rows:
        print(*row, sep="\t")
    sys.exit()
common.table("ironing", header, rows)

colours = dict(zip(bases, ["#bbbbbb", "#e0a030", "#d06020", "#a01010", "#80b0e0", "#3070c0", "#103080", "#10a040"]))
for mesh in meshes:
    figure, axes = plt.subplots(1, 2, figsize=(11, 4))
    for basis in bases:
        if (basis, mesh) not in slides:
            continue
        slide = slides[basis, mesh][1]
        axes[0].plot(slide.s, -slide.py, lw=0.9, color=colours[basis], label=basis)
        axes[1].plot(slide.s, slide.px, lw=0.9, color=colours[basis], label=basis)
    axes[0].set(xlabel="slide s", ylabel="vertical reaction", title=f"mesh {mesh}")
    axes[1].set(xlabel="slide s", ylabel="horizontal reaction", title=f"mesh {mesh}")
    axes[0].legend(ncol=2, fontsize=8)
    figure.tight_layout()
    common.figure(figure, f"ironing_history_{mesh}")

figure, axes = plt.subplots(1, 3, figsize=(14, 4.2))
for basis in bases:
    done = [slides[basis, mesh] for mesh in meshes if (basis, mesh) in slides]
    if not done:
        continue
    n = [item[0] for item in done]
    style = dict(marker={"L": "s", "N": "o", "T": "D"}[basis[0]], color=colours[basis], label=basis)
    axes[0].loglog(n, [item[1].smooth[0] for item in done], **style)
    axes[1].loglog(n, [item[1].smooth[1] for item in done], **style)
    axes[2].loglog([item[2].seconds for item in done], [item[1].smooth[0] for item in done], **style)
axes[0].set(xlabel="dofs", ylabel="oscillation of Py, detrended")
axes[1].set(xlabel="dofs", ylabel="oscillation of Px, detrended")
axes[2].set(xlabel="run time [s]", ylabel="oscillation of Py, detrended")
axes[0].legend(fontsize=8)
figure.tight_layout()
common.figure(figure, "ironing_oscillation")

# the meshes of the three bases and the coarsest T-mesh with its vertical stress, in the middle of the slide
for basis in ("L2", "N3", "T3"):
    for mesh in meshes:
        common.mesh_picture(f"ironing_{basis}_{mesh}", f"ironing_mesh_{basis}_{mesh}", "none", 260)
common.mesh_picture("ironing_T3_1", "ironing_T3_stress", "stress_yy", 260)
