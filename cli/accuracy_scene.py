"""`thurston accuracy SCENE`: what each method costs in a scene, and how wrong its picture is."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import click

from thurston_cl.errors import Interrupted

from .options import check_size

if TYPE_CHECKING:
    from thurston_cl.accuracy.knobs import Row

# Pixels of the picture where --size does not say: enough for a share of 0.1 %, and few enough to wait for.
SIZE = (320, 180)


def report_scene(
    name: str,
    *,
    defines: dict[str, str],
    sets: tuple[str, ...],
    as_json: bool,
    as_csv: bool,
    device: str | None,
    quiet: bool,
    size: tuple[int, int] | None = None,
    draw: Callable[[Callable[[str], None]], None] | None = None,
) -> None:
    """Measure a scene and print the table; progress goes to stderr, and an interrupt prints what is finished.

    size: of the picture, None for about `SIZE`. draw: called with what draws the plot into a file, where one
    is asked for. Raises SceneError, NoDeviceError where the device has no double precision.
    """
    from thurston_cl.accuracy import knobs, knobs_table
    from thurston_cl.device import choose
    from thurston_cl.scene import load_scene
    from thurston_cl.scene.picture import fitting_size

    scene = load_scene(name, defines=defines, sets=sets)
    check_size(scene, size)
    size = size or fitting_size(scene.camera.projection.kind, scene.camera.layout, SIZE)
    chosen = choose(device)
    start = time.perf_counter()
    rows: list[Row] = []
    total, interrupted = 0, False

    def progress(done: int, of: int, coming: str) -> None:
        nonlocal total
        total = of
        if not quiet and coming:
            click.echo(f"{done} of {of}, {time.perf_counter() - start:.0f} s: {coming}", err=True)

    try:
        for row in knobs.measure(scene, chosen, size, progress):
            rows.append(row)
    except KeyboardInterrupt:
        interrupted = True
    seconds = time.perf_counter() - start
    if as_json:
        about = {"scene": name, "size": size, "device": chosen.info.name, "seconds": seconds}
        click.echo(knobs_table.as_json(rows, **about, complete=not interrupted))
    elif as_csv:
        click.echo(knobs_table.as_csv(rows), nl=False)
    elif rows:
        click.echo(knobs_table.text(rows, knobs_table.header(name, size, chosen.info.name)))
    if as_csv and rows:
        click.echo(knobs.verdict(rows), err=True)
    sys.stdout.flush()
    if interrupted:
        raise Interrupted(f"{len(rows)} of {total} rows are finished" + " and printed" * bool(rows))
    if draw is not None:
        from thurston_cl.accuracy.knobs_plot import plot

        draw(lambda file: plot(rows, file, f"{name}, {size[0]}x{size[1]}"))
    if not quiet:
        click.echo(f"measured {len(rows)} methods in {seconds:.0f} s on {chosen.info.name}", err=True)
