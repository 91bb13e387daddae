"""Two hemispheres in contact: force and apexes against an axisymmetric shell, smoothness, meshes, pictures."""
import re

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common
import flattened_cap
import shell_pictures

deck, depth, steps = "inputs/hemispheres.inp", 0.2, 15


def roughness(u, force):
    """What a polynomial of fifth degree through the origin leaves of the curve, largest - smallest [% of the last force]."""
    powers = numpy.array([u**k for k in range(1, 6)]).T
    rest = force - powers @ numpy.linalg.lstsq(powers, force, rcond=None)[0]
    return 100 * (rest.max() - rest.min()) / force[-1]


class Press(common.Run):
    def __init__(self, label, **parameters):
        super().__init__(deck, label, **parameters)
        self.u = -numpy.array(self.history["rim_uz"])
        self.force = -numpy.array(self.history["rim_rz"])
        self.apexes = [self.history[f"apex_{body}_uz"] for body in ("lower", "upper")]
        self.balance = numpy.abs(self.force - numpy.array(self.history["base_rz"])).max()
        self.energy = abs(self.history["energy_error"][-1])
        self.sizes = [int(number) for number in re.search(r"(\d+) equations, (\d+) interface points", self.log).groups()]
        self.indefinite = int(re.search(r"\((\d+) not positive definite", self.log)[1])
        self.total = float(re.search(r"^total +([0-9.]+) s", self.log, re.M)[1])

    def part(self, *phases):
        return f"{100 * sum(self.share(phase) for phase in phases) / self.total:.0f}"


# one hemisphere on a rigid plane: half of U, and a penalty for half of the gap
lifts = depth * numpy.arange(1, steps + 1) / steps
plane = flattened_cap.press(lifts / 2)

meshes = {mesh: Press(f"hemispheres_{mesh}", mesh=mesh) for mesh in (1, 2, 3)}
variants = [("cap55.obj", Press("hemispheres_cap55", control="cap55")),
            ("both bodies slaves", Press("hemispheres_passes", passes=2)),
            ("4 x 4 points", Press("hemispheres_gp4", gp=4)),
            ("penalty 1e5", Press("hemispheres_penalty", penalty=1e5)),
            ("60 steps", Press("hemispheres_steps", steps=60)),
            ("no local refinement", Press("hemispheres_plain", pole=0))]

rows = []
for step in (1, 2, 3, 4, 5, 8, 10, 12, 15):
    k = step - 1
    run = meshes[2]
    rows.append([step, f"{lifts[k]:.4f}", f"{plane[k, 1]:.4f}"]
                + [f"{100 * (mesh.force[k] / plane[k, 1] - 1):+.1f}" for mesh in meshes.values()]
                + [f"{100 * (variants[0][1].force[k] / run.force[k] - 1):+.2f}"]
                + [f"{plane[k, 2] - lifts[k] / 2:.5f}, {-plane[k, 2] - lifts[k] / 2:.5f}",
                   f"{run.apexes[1][k]:.5f}, {run.apexes[0][k]:.5f}"])
common.table("hemispheres_history", ["step", "-rim_uz", "axisymmetric", "mesh 1 [%]", "mesh 2 [%]", "mesh 3 [%]",
                                     "cap55.obj from half_cube.obj [%]", "apexes, axisymmetric", "apexes, mesh 2"], rows)

rows = []
for name, run in [(f"mesh {mesh}" + (" (default)" if mesh == 2 else ""), run) for mesh, run in meshes.items()] + variants:
    every = len(run.u) // steps
    off = 100 * numpy.abs(run.force[every - 1::every] / plane[:, 1] - 1)
    if name.startswith("penalty"):   # another problem
        off = 100 * numpy.abs(run.force / flattened_cap.press(lifts / 2, penalty=2e5)[:, 1] - 1)
    rows.append([name, *run.sizes, f"{off[:3].max():.1f}", f"{off[3:].max():.1f}", f"{roughness(run.u, run.force):.2f}",
                 f"{run.apexes[0][-1]:.5f}", f"{run.apexes[1][-1]:.5f}", f"{100 * run.energy:.2f}", run.indefinite, int(run.iterations),
                 int(sum(run.history["cutbacks"])), f"{run.seconds:.0f}", run.part("elements"), run.part("contact", "search"),
                 run.part("pattern", "analyse", "factorise", "solve"), run.part("input", "prepare")])
for count in (steps, 4 * steps):
    u = depth * numpy.arange(1, count + 1) / count
    exact = flattened_cap.press(u / 2)
    rows.append([f"axisymmetric, {count} steps", "", "", "", "", f"{roughness(u, exact[:, 1]):.2f}", f"{-exact[-1, 2] - depth / 2:.5f}",
                 f"{exact[-1, 2] - depth / 2:.5f}"] + [""] * 9)
common.table("hemispheres_meshes", ["run", "equations", "interface points", "force, steps 1-3 [%]", "steps 4-15 [%]", "roughness [%]",
                                    "apex_lower_uz", "apex_upper_uz", "energy error [%]", "indefinite tangents", "iterations",
                                    "cut-backs", "time [s]", "elements [%]", "contact [%]", "solver [%]", "mesh [%]"], rows)
print("largest imbalance of the rims' forces:", max(run.balance for run in meshes.values()))

# small loads: the penalty's share taken off
rows = []
for t in (0.1, 0.05, 0.02):
    flat = 4 * 1e3 * t**2 / numpy.sqrt(3 * (1 - 0.3**2))
    small = flattened_cap.press([0.05 * t, 0.02 * t], t=t, penalty=2e5 * t, elements=300)[1]
    rows.append([t, f"{flat / 2:.3f}", f"{small[1] / (small[0] - small[3]) / 2:.3f}",
                 f"{small[1] / (small[0] - small[3]) / flat:.3f}"])
common.table("hemispheres_stiffness", ["t/R", "k/2, shallow shell", "axisymmetric", "ratio"], rows)

chart, panels = plt.subplots(1, 2, figsize=(11, 4.2))
panels[0].plot([0, *lifts], [0, *plane[:, 1]], "k", linewidth=2.5, alpha=0.3, label="axisymmetric shell on a plane")
for mesh, run in meshes.items():
    panels[0].plot([0, *run.u], [0, *run.force], ".-", linewidth=0.8, label=f"mesh {mesh}, {run.sizes[0]} equations")
    panels[1].plot(run.u, 100 * (run.force / plane[:, 1] - 1), ".-", linewidth=0.8, label=f"mesh {mesh}")
panels[1].plot(lifts, 100 * (variants[0][1].force / plane[:, 1] - 1), "x--", linewidth=0.8, label="mesh 2, cap55.obj")
panels[0].set(xlabel="-rim_uz", ylabel="-rim_rz")
panels[1].set(xlabel="-rim_uz", ylabel="difference from the axisymmetric shell [%]")
for one in panels:
    one.legend(fontsize=8)
    one.grid(alpha=0.3)
chart.tight_layout()
common.figure(chart, "hemispheres")

# the paper's figures 15 to 17: half of both bodies
found = shell_pictures.results(meshes[2].folder)
chart, panels = plt.subplots(3, 4, figsize=(10.5, 7))
limits = {"ux": 0.025, "uy": 0.025, "uz": depth}
for row, step in zip(panels, (5, 10, 15)):
    for axes, field in zip(row, (None, "ux", "uy", "uz")):
        low = -limits[field] if field else -1
        cmap = "viridis" if field == "uz" else "RdBu_r"
        norm = matplotlib.colors.Normalize(low, 0 if field == "uz" else -low)
        shell_pictures.panel(axes, found, step, field, norm, (-80, 8), keep=lambda x: x[:, 1] > 0,
                             cmap=cmap)
        axes.set_title(f"step {step}" + (f", {field}" if field else ""), fontsize=10)
        if field:
            chart.colorbar(plt.cm.ScalarMappable(norm, cmap), ax=axes, shrink=0.6)
chart.tight_layout()
common.figure(chart, "hemispheres_fields")
