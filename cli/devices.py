"""`thurston devices`: which OpenCL devices there are, and whether they work."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import click

from thurston_cl import device
from thurston_cl.errors import NoDeviceError

HEADINGS = ("id", "platform", "version", "device", "kind", "fp64", "native", "lanes", "builds")


@click.command()
@click.option("--check", is_flag=True, help="Build and run a kernel on each device, and say which works.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(check: bool, as_json: bool) -> None:
    """List every OpenCL platform and device.

    NATIVE is the native vector width and LANES the number of rays marched side by side, each in
    single/double precision. Other commands use the device named by --device, else by THURSTON_DEVICE,
    else by PYOPENCL_CTX (cpu, gpu, an id, or part of a name), else the first GPU that works, else the
    first CPU that does.

    Exit code 69 if there is no device, or with --check if none works.
    """
    infos = device.list_devices()
    probes = [device.probe(info, fresh=True) if check else None for info in infos]
    entries = [_entry(info, probe) for info, probe in zip(infos, probes, strict=True)]
    if as_json:
        click.echo(json.dumps({"devices": entries}, indent=2))
    elif entries:
        _print_table(entries)
    for info, probe in zip(infos, probes, strict=True):
        if probe and not probe.ok:
            click.echo(f"thurston: warning: {info.id} {info.name}: {probe.message}; {probe.cure}", err=True)
    if not infos:
        raise NoDeviceError(device.no_device_message())
    if check and not any(probe and probe.ok for probe in probes):
        raise NoDeviceError("no OpenCL device can build and run a kernel")


def _entry(info: device.DeviceInfo, probe: device.Probe | None) -> dict[str, Any]:
    """One device as `--json` shows it; `builds` is null where it was not checked."""
    return dataclasses.asdict(info) | {
        "lane_width": {precision: info.lane_width(precision) for precision in device.PRECISIONS},
        "builds": probe.ok if probe else None,
        "message": probe.message if probe else "",
        "cure": probe.cure if probe else "",
    }


def _print_table(entries: list[dict[str, Any]]) -> None:
    builds = {None: "not checked (--check)", True: "yes", False: "no"}
    rows = [HEADINGS] + [
        (
            entry["id"],
            entry["platform"],
            entry["platform_version"].split("  ")[0],  # PoCL adds its build options, after two blanks
            entry["name"],
            entry["kind"],
            "yes" if entry["fp64"] else "no",
            f"{entry['native_width_float']}/{entry['native_width_double']}",
            f"{entry['lane_width']['single']}/{entry['lane_width']['double'] if entry['fp64'] else '-'}",
            builds[entry["builds"]],
        )
        for entry in entries
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADINGS))]
    for row in rows:
        click.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
