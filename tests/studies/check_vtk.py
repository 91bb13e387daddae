#!/usr/bin/env python3
"""What VTK shows of result folders against the splines themselves.

    check_vtk.py FOLDER

FOLDER holds `plane` and `solid` of vtk_samples (quarter rings, so that the radius is checked too). Every cell of every
output is evaluated by VTK at random places, from the .vtu files and from results.vtkhdf, and compared with the control
values, weights and extraction operators in the group /bezel. Needs the Python packages vtk, numpy and h5py. Exit status
1 if anything differs.
"""
import sys
from math import comb
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

POINTS = 200            # places in each cell
TOLERANCE = 1e-12       # of lengths of order 1: a few hundred roundings of sums over up to 60 products
worst = 0.0


def compare(what, found, expected, quiet=False):
    global worst
    error = float(np.max(np.abs(np.asarray(found) - expected))) if np.size(expected) else 0.0
    worst = max(worst, error if error == error else np.inf)
    if not error <= TOLERANCE:
        print(f'  WRONG {what}: off by {error:.3g}')
    elif not quiet:
        print(f'  {what}: within {error:.1e}')


def bernstein(p, x):
    return np.array([comb(p, i) * x**i * (1 - x)**(p - i) for i in range(p + 1)])


class Splines:
    """The mesh as the program knows it."""

    def __init__(self, file):
        mesh = file['bezel/mesh']
        get = lambda name: np.asarray(mesh[name])
        self.x, self.w, self.degree = get('nodes'), get('weights'), get('degree')
        start, nodes = get('connectivity_start') - 1, get('connectivity') - 1
        first, coef = get('operator_start') - 1, get('operators')
        rows, columns = get('operator_rows'), get('operator_columns')
        self.elements = []
        for e, op in enumerate(get('operator_of') - 1):
            c = coef[first[op]:first[op + 1]].reshape(columns[op], rows[op]).T
            self.elements.append((nodes[start[e]:start[e + 1]], c))
        self.u = np.asarray(file['bezel/displacement'])
        self.times = np.asarray(file['bezel/steps/time'])

    def shape(self, e, xi):
        bez = np.ones(1)
        for p, x in zip(self.degree[e], xi):
            bez = np.outer(bernstein(p, x), bez).ravel()        # the first direction is the fastest
        nodes, c = self.elements[e]
        r = self.w[nodes] * (c @ bez)
        return nodes, r / r.sum()


def three(values):
    return np.pad(values, (0, 3 - len(values)))


def check_grid(name, grid, splines, u, random, rational=True):
    """All cells of one output; returns nothing, `worst` tells."""
    data = grid.GetPointData()
    arrays = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}
    if rational:
        active = data.GetRationalWeights() is not None and grid.GetCellData().GetHigherOrderDegrees() is not None
        if not active:
            compare(f'{name}: active attributes', np.nan, 0.0)
            return
    error = {'place': [], 'displacement': [], 'stress': [], 'ones': [], 'radius': []}
    for e in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(e)
        ids = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
        for _ in range(POINTS):
            xi = random.random(3)
            nodes, shp = splines.shape(e, xi)
            place, weights = [0.0] * 3, [0.0] * len(ids)
            cell.EvaluateLocation(vtk.reference(0), list(xi), place, weights)
            x = three(shp @ splines.x[nodes])
            error['place'].append(np.abs(np.array(place) - x).max())
            error['radius'].append(abs(np.hypot(place[0], place[1]) - 1 - xi[1]))
            error['displacement'].append(np.abs(weights @ arrays['displacement'][ids] - three(shp @ u[nodes])).max())
            stress = np.array([x[0], x[1], x[2], x[0] - x[1], 0, 0])
            error['stress'].append(np.abs(weights @ arrays['stress'][ids] - stress).max())
            error['ones'].append(abs(weights @ arrays['ones'][ids] - 1))
    for what, values in error.items():
        compare(f'{name}: {what}', max(values), 0.0, quiet=True)
    print(f'  {name}: within {max(max(values) for values in error.values()):.1e}')


def check_folder(folder):
    print(folder)
    random = np.random.default_rng(1)
    with h5py.File(folder / 'results.vtkhdf') as file:
        splines = Splines(file)
    for step, u in enumerate(splines.u):
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(folder / f'fields_{step:06d}.vtu'))
        reader.Update()
        grid = reader.GetOutput()
        check_grid(f'fields_{step:06d}.vtu', grid, splines, u, random)
        cells = grid.GetCellData()
        compare('material', vtk_to_numpy(cells.GetArray('material')), [1, 1], quiet=True)
        compare('body', vtk_to_numpy(cells.GetArray('body')), [1, 2], quiet=True)
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(folder / f'interface_{step:06d}.vtu'))
        reader.Update()
        grid = reader.GetOutput()
        compare('vertices', grid.GetNumberOfCells(), step, quiet=True)
        if step:
            expected = 0.1 * np.arange(1, 3 * step + 1).reshape(step, 3)
            compare('vertices', vtk_to_numpy(grid.GetPoints().GetData()), expected, quiet=True)
            compare('vertices', vtk_to_numpy(grid.GetPointData().GetArray('gap')), expected[:, 0], quiet=True)

    version = tuple(int(n) for n in vtk.vtkVersion().GetVTKVersion().split('.')[:2])
    if version < (9, 3):
        print('  results.vtkhdf: this VTK does not read time series')
        return
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(folder / 'results.vtkhdf'))
    reader.UpdateInformation()
    steps = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    compare('results.vtkhdf: times', steps, splines.times)
    for step, u in enumerate(splines.u):
        reader.UpdateTimeStep(splines.times[step])
        output = reader.GetOutputDataObject(0)
        grid = output
        while not grid.IsA('vtkUnstructuredGrid'):
            grid = grid.GetPartition(0) if grid.IsA('vtkPartitionedDataSet') else grid.GetBlock(0)
        data = grid.GetPointData()
        rational = data.GetRationalWeights() is not None
        if not rational:                                       # before 9.7: made active by hand
            copy = vtk.vtkUnstructuredGrid()
            copy.ShallowCopy(grid)
            copy.GetPointData().SetRationalWeights(copy.GetPointData().GetArray('RationalWeights'))
            grid = copy
        if grid.GetCellData().GetHigherOrderDegrees() is None:
            grid.GetCellData().SetHigherOrderDegrees(grid.GetCellData().GetArray('HigherOrderDegrees'))
        if step == 0:
            print(f'  results.vtkhdf: rational weights are {"" if rational else "not "}active by themselves')
        check_grid(f'results.vtkhdf, step {step}', grid, splines, u, random)


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ('-h', '--help'):
        print(__doc__)
        return 2
    print('VTK', vtk.vtkVersion().GetVTKVersion())
    for name in 'plane', 'solid':
        check_folder(Path(sys.argv[1]) / name)
    print(f'largest difference {worst:.2e}, allowed {TOLERANCE:.0e}: {"right" if worst <= TOLERANCE else "WRONG"}')
    return 0 if worst <= TOLERANCE else 1


if __name__ == '__main__':
    sys.exit(main())
