"""Reads every frame of results folders with meshio and with VTK: the two agree with each other, with
summary.json and with history.csv. Usage: read_frames.py FOLDER..."""

import csv
import json
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

# Number of components of what a frame has when no fields are chosen.
FIELDS = {
    "displacement": 3,
    "velocity": 3,
    "deformation_gradient": 9,
    "jacobian": 1,
    "determinant": 1,
    "cauchy_stress": 9,
    "von_mises_stress": 1,
    "pressure": 1,
    "equivalent_plastic_strain": 1,
    "wave_speed": 1,
}
VTK_TYPES = {"vertex": vtk.VTK_VERTEX, "quad": vtk.VTK_QUAD, "hexahedron": vtk.VTK_HEXAHEDRON}
CHOSEN = {"velocity": 3, "equivalent_plastic_strain": 1, "cauchy_stress": 9}


def check(condition, message):
    if not condition:
        raise SystemExit(f"error: {message}")


def read_vtk(path):
    """Points, point data, cells by type and field data as VTK, and so ParaView and pyvista, sees them."""
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    check(reader.GetErrorCode() == 0, f"VTK cannot read {path}")
    grid = reader.GetOutput()
    data = grid.GetPointData()
    arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    time = grid.GetFieldData().GetArray("TimeValue").GetValue(0)
    types = {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    return vtk_to_numpy(grid.GetPoints().GetData()), arrays, types, connectivity, time


def read_vtkhdf(path):
    """The same of a VTKHDF file."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    time = grid.GetFieldData().GetArray("TimeValue").GetValue(0)
    data = grid.GetPointData()
    arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    types = {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    return vtk_to_numpy(grid.GetPoints().GetData()), arrays, types, connectivity, time


def compare_vtkhdf(path, frame):
    """A VTKHDF file has what the VTU file beside it has, bit for bit."""
    points, arrays, types, connectivity, time = frame
    found = read_vtkhdf(path)
    check(np.array_equal(found[0], points) and found[0].dtype == points.dtype, f"{path}: points")
    check(set(found[1]) == set(arrays), f"{path}: fields {sorted(found[1])}")
    for name, values in arrays.items():
        check(np.array_equal(found[1][name], values) and found[1][name].dtype == values.dtype, f"{path}: {name}")
    check(found[2] == types and np.array_equal(found[3], connectivity), f"{path}: cells")
    check(found[4] == time, f"{path}: TimeValue {found[4]}")


def read_history(folder):
    with open(folder / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {float(row["time"]): row for row in rows}


def read_collection(folder):
    root = ElementTree.parse(folder / "frames" / "frames.pvd").getroot()
    return [(float(entry.get("timestep")), folder / "frames" / entry.get("file")) for entry in root.iter("DataSet")]


def read_folder(folder):
    is_single = folder.name.startswith("single")
    summary = json.loads((folder / "summary.json").read_text())
    history = read_history(folder)
    collection = read_collection(folder)
    expected = CHOSEN if folder.name == "single-compressed" else FIELDS
    cell = "vertex" if folder.name == "single-compressed" else ("quad" if "ecae" in summary["case"] else "hexahedron")
    kind = np.float32 if is_single else np.float64
    times = [time for time, _ in collection]
    check(len(times) >= 3 and times[0] == 0.0, f"{folder}: {len(times)} frames")
    check(all(a < b for a, b in zip(times, times[1:])), f"{folder}: times do not increase")
    check(times[-1] == summary["simulated_time"], f"{folder}: the last frame is not the end")
    written = sorted((folder / "frames").glob("*.vtu"))
    check(written == [path for _, path in collection], f"{folder}: frames.pvd does not list the frames")
    hdf = sorted((folder / "frames").glob("*.vtkhdf"))
    check(not hdf or [path.with_suffix(".vtkhdf") for _, path in collection] == hdf, f"{folder}: VTKHDF files")
    compared = 0
    for time, path in collection:
        points, arrays, types, connectivity, vtk_time = read_vtk(path)
        if hdf:
            compare_vtkhdf(path.with_suffix(".vtkhdf"), (points, arrays, types, connectivity, vtk_time))
        mesh = meshio.read(path)
        check(vtk_time == time, f"{path}: TimeValue {vtk_time}, frames.pvd {time}")
        check(points.shape == (summary["particles"], 3), f"{path}: {points.shape} points")
        check(np.array_equal(points, mesh.points), f"{path}: meshio and VTK differ in the points")
        check(set(arrays) == set(expected), f"{path}: fields {sorted(arrays)}")
        check(set(mesh.point_data) == set(expected), f"{path}: meshio's fields {sorted(mesh.point_data)}")
        for name, components in expected.items():
            values = arrays[name]
            check(values.dtype == kind, f"{path}: {name} is {values.dtype}")
            check(values.size == components * len(points), f"{path}: {name} has shape {values.shape}")
            check(np.isfinite(values).all(), f"{path}: {name} is not finite")
            other = np.asarray(mesh.point_data[name]).reshape(values.shape)
            check(np.array_equal(values, other), f"{path}: meshio and VTK differ in {name}")
        blocks = {block.type: block.data for block in mesh.cells}
        check(set(blocks) == {cell}, f"{path}: cells {sorted(blocks)}")
        check(np.array_equal(blocks[cell].ravel(), connectivity), f"{path}: meshio and VTK differ in the cells")
        check(types == {VTK_TYPES[cell]}, f"{path}: VTK's cells are of types {types}")
        if time in history:
            compared += 1
            compare(path, arrays, history[time], kind)
    check(compared >= 2, f"{folder}: only {compared} frames fall on rows of the history")
    last = read_vtk(collection[-1][1])[1]
    extreme = kind(summary["extremes"]["equivalent_plastic_strain"])
    found = last["equivalent_plastic_strain"].max()
    check(found == extreme and found > 0, f"{folder}: plastic strain {found}, summary.json {extreme}")
    if "jacobian" in last:
        check(last["jacobian"].min() == kind(summary["extremes"]["jacobian_min"]), f"{folder}: smallest J")
        # Of means over bonds only linear relations hold: the pressure is a third of the trace.
        stress = last["cauchy_stress"].reshape(-1, 3, 3).astype(float)
        rounding = 1e-6 * np.abs(stress).max()
        check(np.allclose(stress.trace(axis1=1, axis2=2) / 3, last["pressure"], rtol=0, atol=rounding), f"{folder}: pressure")
    also = " (and as VTKHDF)" if hdf else ""
    print(f"{folder.name}: {len(collection)} frames{also} of {summary['particles']} particles, {found:.6g} plastic strain")


def compare(path, arrays, row, kind):
    """A frame and the row of the same time have the same extremes, to the bit in the frame's precision."""
    found = arrays["equivalent_plastic_strain"].max()
    check(found == kind(row["equivalent_plastic_strain"]), f"{path}: plastic strain {found}")
    if "jacobian" in arrays:
        check(arrays["jacobian"].max() == kind(row["jacobian_max"]), f"{path}: largest J")


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        read_folder(Path(argument))
