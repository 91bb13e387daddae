"""Debonding: moment of the double cantilever beam over basis, mesh, Gauss points and strength; energies; closed forms [parts=a,b,c,d,e]."""
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common

parts = "abcde"
for argument in sys.argv[1:]:
    name, value = argument.split("=")
    if name == "parts":
        parts = value.replace(",", "")
    else:
        sys.exit(f"unknown argument {argument}; known: parts=")

ebm, opening, bar = "inputs/dcb_ebm.inp", "inputs/dcb_opening.inp", "inputs/snap_back.inp"
e_plane = 122e3 / (1 - 0.25**2)
m_c = math.sqrt(0.1 * e_plane / 12)
zone = 3.0  # length of the softening zone for p_max = 4 [mm]
every = ["L1", "L2", "L3", "N2", "N3", "N4", "T3"]
colours = dict(zip(every, ["#bbbbbb", "#e0a030", "#a01010", "#80b0e0", "#3070c0", "#103080", "#10a040"]))


class Opening:
    """The double cantilever beam under rotations: one run and what is judged of it."""

    def __init__(self, label, basis, **parameters):
        known = dict(basis=basis[0], p=basis[1])
        if basis[0] == "T":
            known = dict(basis="T")
        self.run = common.Run(ebm, f"debonding_{label}", **known, **parameters)
        h = self.run.history
        self.m, self.rotation, self.d = h.get("arm_m", []), h.get("arm_rot", []), h.get("dissipated", [])
        self.steps = len(self.m)
        self.passed = self.run.status == 0
        first = next((k for k in range(self.steps) if self.m[k] >= 0.999 * m_c), None)
        self.grows = first is not None and self.d[-1] > self.d[first]
        if not self.grows:
            return
        m, d = self.m[first:], self.d[first:]
        self.oscillation = (max(m) - min(m)) / m_c
        # over the growth of the crack, which the dissipated energy measures
        mean = sum((m[k] + m[k + 1]) / 2 * (d[k + 1] - d[k]) for k in range(len(m) - 1)) / (d[-1] - d[0])
        self.plateau = mean / m_c - 1
        late = [x for x, e in zip(m, d) if e >= d[0] + (d[-1] - d[0]) / 3]
        self.steady = (max(late) - min(late)) / m_c
        self.balance = max(abs(x) for x in h["energy_error"])
        self.iterations = self.run.iterations / self.steps
        self.cutbacks = int(sum(h["cutbacks"]))

    def end(self):
        """How the run ended, in words."""
        if self.passed:
            return ""
        return f"stops at rotation {self.rotation[-1]:.3f}" if self.steps else "stops in the first step"

    def at(self, rotation):
        """Moment at a rotation before the crack grows."""
        for k in range(self.steps - 1):
            r, s = self.rotation[k], self.rotation[k + 1]
            if r <= rotation <= s and s > r:
                return self.m[k] + (self.m[k + 1] - self.m[k]) * (rotation - r) / (s - r)
        return float("nan")

    def columns(self):
        if not self.grows:
            return ["", "", "", "", "", "", f"{self.run.seconds:.1f}"]
        return [f"{100 * self.plateau:.2f}", f"{100 * self.oscillation:.2f}", f"{100 * self.steady:.2f}", f"{self.iterations:.1f}", self.cutbacks,
                f"{self.balance:.0e}", f"{self.run.seconds:.1f}"]


def dofs(**parameters):
    text = common.check(ebm, **parameters)
    return int(next(line.split()[1] for line in text.splitlines() if line.startswith("dofs")))


# (a) bases and meshes; what of the path is looked at ends with `last`
ends = {1: 0.12, 2: 0.12, 3: 0.06}
if "a" in parts:
    rows, runs = [], {}
    for basis in every:
        for mesh in (1, 2, 3):
            one = Opening(f"{basis}_{mesh}", basis, mesh=mesh, last=ends[mesh])
            runs[basis, mesh] = one
            n = dofs(basis=basis[0], p=basis[1], mesh=mesh)
            early = " / ".join(f"{one.at(r):.2f}" for r in (0.005, 0.01, 0.02)) if one.steps else ""
            rows.append([basis, mesh, n, one.end(), early, *one.columns()])
            print(rows[-1], flush=True)
    # as many dofs as mesh 2, but all of them along the beam
    one = Opening("N3_long", "N3", mesh=2, along=178, across=1, last=ends[2])
    rows.append(["N3, 178 x 1", 2, 2896, one.end(), " / ".join(f"{one.at(r):.2f}" for r in (0.005, 0.01, 0.02)), *one.columns()])
    common.table("debonding", ["basis", "mesh", "dofs", "end", "M at rotation 0.005 / 0.01 / 0.02", "plateau [%]", "oscillation [%]",
                               "last two thirds [%]", "iterations a point", "cut-backs", "largest energy_error", "time [s]"], rows)

    figure, axes = plt.subplots(2, 3, figsize=(15, 8))
    for mesh in (1, 2, 3):
        for axis, limits in zip(axes[:, mesh - 1], ((0, 1.4 * m_c), (0.94 * m_c, 1.06 * m_c))):
            for basis in every:
                one = runs[basis, mesh]
                axis.plot(one.rotation, one.m, lw=0.9, color=colours[basis], label=basis)
            axis.axhline(m_c, color="black", lw=0.6, ls=":")
            axis.set(xlabel="rotation", ylim=limits, xlim=(0, ends[mesh]))
        axes[0, mesh - 1].set(title=f"mesh {mesh}")
    axes[0, 0].set(ylabel="M [N mm/mm]")
    axes[1, 0].set(ylabel="M, the plateau alone")
    axes[0, 0].legend(fontsize=8, ncol=2, loc="lower right")
    figure.tight_layout()
    common.figure(figure, "debonding_moment")

    rows = []
    for basis in ("L2", "N3", "T3"):
        row = [basis]
        for strength in (4, 8, 16):
            one = Opening(f"{basis}_2_p{strength}", basis, mesh=2, last=0.06, pmax=strength)
            row.append(f"{100 * one.oscillation:.2f}" + ("" if one.passed else f" ({one.end()})") if one.grows else one.end())
        rows.append(row)
    common.table("debonding_strength", ["oscillation [%], mesh 2", "p_max = 4", "8", "16"], rows)

# (b) Gauss points against mesh, (c) the coarsest mesh that passes
coarse = {"L2": (18, 24, 48, 71), "N3": (24, 35, 70, 140), "T3": (24, 37, 56, 94)}
points = {"L2": (2, 3, 4, 8), "N3": (2, 3, 4, 5, 6, 8), "T3": (2, 3, 4, 8)}


hues = {2: "#d04020", 3: "#e0a030", 4: "#10a040", 5: "#30b0b0", 6: "#3070c0", 8: "#103080"}


def trade(basis, along, gp):
    across = 2 if basis == "T3" or along >= 140 or (basis == "L2" and along >= 71) else 1
    one = Opening(f"{basis}_{along}_{gp}", basis, mesh=1, along=along, across=across, gp=gp, last=0.08)
    one.size = 140 / along / (2 if basis == "T3" else 1)
    return one


if "b" in parts or "c" in parts:
    rows, runs = [], {}
    for basis in coarse:
        for along in coarse[basis]:
            for gp in points[basis]:
                one = trade(basis, along, gp)
                runs[basis, along, gp] = one
                rows.append([basis, along, f"{one.size:.2f}", f"{zone / one.size:.1f}", gp, one.end(), *one.columns()])
                print(rows[-1], flush=True)
    common.table("debonding_points", ["basis", "elements along", "element at the interface [mm]", "elements in the softening zone",
                                      "gp", "end", "plateau [%]", "oscillation [%]", "last two thirds [%]", "iterations a point",
                                      "cut-backs", "largest energy_error", "time [s]"], rows)
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.4))
    for basis, marker in zip(coarse, "sod"):
        for gp, colour in ((gp, hues[gp]) for gp in points[basis]):
            done = [runs[basis, n, gp] for n in coarse[basis] if runs[basis, n, gp].grows and runs[basis, n, gp].passed]
            label = f"{basis}, gp = {gp}" if basis == "N3" or gp == 2 else None  # the others by line and colour
            style = dict(marker=marker, color=colour, ls={"L2": ":", "N3": "-", "T3": "--"}[basis], lw=0.9, ms=4)
            axes[0].loglog([o.size for o in done], [100 * o.oscillation for o in done], label=label, **style)
            axes[1].loglog([o.run.seconds for o in done], [100 * o.oscillation for o in done], **style)
    axes[0].set(xlabel="element at the interface [mm]", ylabel="oscillation [%]")
    axes[1].set(xlabel="run time [s]", ylabel="oscillation [%]")
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    common.figure(figure, "debonding_points")

    rows = []
    for basis in coarse:
        for gp in points[basis]:
            ok = [n for n in coarse[basis] if runs[basis, n, gp].passed]
            small = [n for n in ok if runs[basis, n, gp].grows and runs[basis, n, gp].oscillation < 0.05]
            fails = [n for n in coarse[basis] if not runs[basis, n, gp].passed]
            text = lambda n: f"{zone / runs[basis, n, gp].size:.1f}"
            rows.append([basis, gp, text(min(ok)) if ok else "none", text(min(small)) if small else "none",
                         ", ".join(f"{text(n)}: {runs[basis, n, gp].end()}" for n in fails)])
    common.table("debonding_zone", ["basis", "gp", "fewest elements in the softening zone that pass", "with an oscillation below 5 %",
                                    "those that stop"], rows)

# (d) energies when all of a bond is gone
if "d" in parts:
    rows = []
    for along in (56, 70, 140):
        for gp in (2, 4, 8):
            row = [f"{140 / along:.2f}", f"{140 / along / zone:.2f}", gp]
            for first, last in ((4, 14), (4, 14.3)):
                one = Opening(f"whole_{along}_{gp}_{first}", "N3", mesh=1, along=along, across=1, gp=gp, penalty=1e3, crack=first,
                              glued=last, last=0.05, tol=1e-8)
                active = one.run.history["active"][-1] if one.steps else -1
                row += [f"{one.d[-1] / (0.1 * (last - first)) - 1:.1e}" if one.passed and active == 0 else one.end() or "not whole",
                        f"{max(abs(x) for x in one.run.history['energy_error']):.0e}" if one.steps else ""]
            rows.append(row)
            print(row, flush=True)
    common.table("debonding_energy", ["element [mm]", "element / softening zone", "gp", "dissipated / (G_IC area) - 1, bond from 4 to 14",
                                      "largest energy_error", "the same, from 4 to 14.3", "largest energy_error"], rows)

# (e) closed forms of the bar and of the beam opened by displacements
if "e" in parts:
    run = common.Run(bar, "debonding_bar")
    h = run.history
    worst = {"rising": 0.0, "softening": 0.0, "apart": 0.0}
    soft = []
    for u, s, d in zip(h["end_ux"], h["end_rx"], h["dissipated"]):
        if d <= 0:
            worst["rising"] = max(worst["rising"], abs(u - s * (0.1 + 0.004)))
        elif s > 1e-9:
            worst["softening"] = max(worst["softening"], abs(u - (0.1 * s + 0.04 - 0.036 * s)))
            soft.append((u, s))
        else:
            worst["apart"] = max(worst["apart"], abs(s))
    rows = [["bar, rising: largest error of u", f"{worst['rising']:.1e}"],
            ["bar, snapping back: largest error of u", f"{worst['softening']:.1e}"],
            ["bar, apart: largest stress", f"{worst['apart']:.1e}"],
            ["bar, dissipated / (G_IC area) - 1", f"{h['dissipated'][-1] / 0.02 - 1:.1e}"],
            ["bar, largest energy_error", f"{max(abs(x) for x in h['energy_error']):.1e}"]]
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2))
    axes[0].plot([0, 0.104, 0.04, 0.12], [0, 1, 0, 0], "-", color="#bbbbbb", lw=3, label="closed form")
    axes[0].plot(h["end_ux"], h["end_rx"], "o", ms=3, color="#3070c0", label="computed")
    axes[0].set(xlabel="u", ylabel="stress", title="bar")
    ei, g, a = e_plane / 12, 0.02, 20
    k = (2 / (2 * 0.002 * ei)) ** 0.25
    for basis, n, gp, last in (("N", 80, 3, 1.6), ("N", 160, 3, 0.8), ("N", 80, 8, 0.8), ("L", 80, 3, 0.8)):
        p = 3 if basis == "N" else 2
        run = common.Run(opening, f"debonding_opening_{basis}{p}_{n}_{gp}", basis=basis, p=p, n=n, gp=gp, last=last)
        h = run.history
        branch = [force / ((g * ei) ** 0.75 / math.sqrt(3 * ei * u)) - 1
                  for u, force, d in zip(h["up_uy"], h["up_ry"], h["dissipated"]) if d > 0.02 * 4]
        before = h["up_ry"][1] / (3 * ei * h["up_uy"][1] / (a**3 + 3 * a * a / k + 3 * a / k**2 + 1.5 / k**3)) - 1
        rows.append([f"beam, {basis}{p}, {n} x 1, gp = {gp}: P before, while the crack grows (mean, smallest, largest) [%]",
                     f"{100 * before:.2f}, {100 * sum(branch) / len(branch):.2f}, {100 * min(branch):.2f}, {100 * max(branch):.2f}"
                     + ("" if run.status == 0 else f" (stops at u = {h['up_uy'][-1]:.2f})")])
        if (basis, n, gp) == ("N", 80, 3):
            axes[1].plot(h["up_uy"], h["up_ry"], color="#3070c0", label="computed")
            u = [0.15 + 0.01 * i for i in range(146)]
            axes[1].plot(u, [(g * ei) ** 0.75 / math.sqrt(3 * ei * x) for x in u], ":", color="black", label="beam theory")
    axes[1].set(xlabel="u [mm]", ylabel="P [N/mm]", title="beam opened by displacements")
    for axis in axes:
        axis.legend(fontsize=8)
    figure.tight_layout()
    common.figure(figure, "debonding_closed_forms")
    common.table("debonding_closed_forms", ["deviation from the closed form", "measured"], rows)
