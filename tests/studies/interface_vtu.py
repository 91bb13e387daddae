"""Reader of interface_*.vtu: the arrays of the interface points (appended raw data) by name."""
import re

import numpy


def read(folder, step=None):
    """Arrays of the last output in a result folder, or of that of a step: Points (n,3), gap, traction, active, paired (n)."""
    raw = sorted(folder.glob("interface_*.vtu" if step is None else f"interface_{step:06d}.vtu"))[-1].read_bytes()
    mark = b'<AppendedData encoding="raw">\n_'
    start = raw.index(mark) + len(mark)
    kinds = {b"Float64": "<f8", b"Int64": "<i8", b"UInt8": "u1"}
    arrays = {}
    for found in re.finditer(rb'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)"[^>]* offset="(\d+)"', raw[:start]):
        at = start + int(found[4])
        kind = numpy.dtype(kinds[found[1]])
        values = numpy.frombuffer(raw, kind, int.from_bytes(raw[at:at + 8], "little") // kind.itemsize, at + 8)
        components = int(found[3])
        arrays[found[2].decode()] = values.reshape(-1, components) if components > 1 else values
    return arrays
