#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens an artefact with h5py, xarray and ncdump, as people outside of this project would.

    open_elsewhere.py FILE

Prints one line a check. Exit code 0 when all pass, 1 when one fails, 2 when a reader is not installed.
"""
import subprocess
import sys

try:
    import h5py
    import xarray
except ImportError as error:
    print(f"open_elsewhere: found {error}, expected it to be installed", file=sys.stderr)
    sys.exit(2)

ROOT_TEXTS = ["Conventions", "schema_name", "schema_version", "title", "history", "creator", "settings"]


def text(attributes, name):
    value = attributes[name]
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def root_attributes(path):
    with h5py.File(path, "r") as file:
        for name in ROOT_TEXTS:
            assert name in file.attrs, f"{name} is missing"
            text(file.attrs, name)
        assert text(file.attrs, "Conventions") == "CF-1.8"
        assert file.attrs["complete"] == 1, "complete is not 1"


def datasets_described(path):
    with h5py.File(path, "r") as file:
        assert len(file) > 0, "no dataset"
        for name, dataset in file.items():
            assert text(dataset.attrs, "units"), f"{name}: no units"
            assert text(dataset.attrs, "long_name"), f"{name}: no long_name"
            assert dataset.dtype.kind in "fi", f"{name}: {dataset.dtype}"
            assert dataset.fletcher32, f"{name}: no checksum"
            dataset[...]


def axes_named(path):
    with h5py.File(path, "r") as file:
        for name, dataset in file.items():
            if h5py.h5ds.is_scale(dataset.id):
                continue
            for number, axis in enumerate(dataset.dims):
                assert len(axis) == 1, f"{name}: axis {number} has {len(axis)} scales"
                assert axis[0].shape == (dataset.shape[number],), f"{name}: axis {number}"


def same_in_xarray(path, engine):
    with h5py.File(path, "r") as file, xarray.open_dataset(path, engine=engine) as opened:
        for name, dataset in file.items():
            variable = opened.variables[name]
            expected = (name,) if h5py.h5ds.is_scale(dataset.id) else tuple(a[0].name[1:] for a in dataset.dims)
            assert variable.dims == expected, f"{name}: {variable.dims}, expected {expected}"
            assert variable.shape == dataset.shape, f"{name}: {variable.shape}"
            assert variable.attrs["long_name"], f"{name}: no long_name"
            variable.load()


def ncdump(path):
    header = subprocess.run(["ncdump", "-h", path], check=True, capture_output=True, text=True).stdout
    assert "phony_dim" not in header, "an axis without a name"
    with h5py.File(path, "r") as file:
        for name, dataset in file.items():
            if h5py.h5ds.is_scale(dataset.id):
                fixed = f"\t{name} = {len(dataset)} ;"
                growing = f"\t{name} = UNLIMITED ; // ({len(dataset)} currently)"
                assert fixed in header or growing in header, f"no dimension {name}"
    subprocess.run(["ncdump", path], check=True, stdout=subprocess.DEVNULL)


def main():
    path = sys.argv[1]
    checks = [
        ("h5py: root attributes", root_attributes),
        ("h5py: units, long_name, checksum", datasets_described),
        ("h5py: named axes", axes_named),
        ("xarray, h5netcdf", lambda p: same_in_xarray(p, "h5netcdf")),
        ("xarray, netcdf4", lambda p: same_in_xarray(p, "netcdf4")),
        ("ncdump", ncdump),
    ]
    failed = 0
    for label, check in checks:
        try:
            check(path)
            print(f"ok: {label}")
        except Exception as error:  # any failure of a foreign reader is a finding
            print(f"FAILED: {label}: {type(error).__name__}: {error}")
            failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
