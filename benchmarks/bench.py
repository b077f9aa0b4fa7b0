"""What lanes, refilling and precision cost or gain, as ratios within one run. Machines are shared: trust the
ratios.

Run with `make bench`, or `python benchmarks/bench.py --repeat 9` for quieter medians. Times are processor
time of all cores together (core-ms), of tracing and shading one sample of every pixel; a kernel's first run
is not counted.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from typing import Any

import numpy as np
from effects import effects, unit_costs
from krs import PLOT, krs
from race import SCENES, contender, race

from thurston_cl import device as devices
from thurston_cl.accuracy import protocol, table
from thurston_cl.device import Device
from thurston_cl.program import LOCAL_SIZE, Source, build_widest, geometry_parts
from thurston_cl.rendering import tiles
from thurston_cl.sampling import sample_shifts

# What we want of PoCL with AVX-512; the machine decides, so these are printed and not checked.
TARGETS = {
    "hyperideal-cube.yaml": "target: under 1000 core-ms; 1 lane at least 15 times the default (8 with AVX2)",
    "ideal-cube.yaml": "target: at most 60 core-ms in the better way, and no black pixel",
}


# Lattices of balls, one light, no shadow: how much more than the flat one do groups cost?
BALL_LATTICES = {
    "ball-lattice-e3.yaml": "three-torus (e3)",
    "ball-lattice-nil.yaml": "Heisenberg (nil); target: at most 6",
    "ball-lattice-sl2.yaml": "tangent bundle, genus two (sl2); target: at most 8",
    "pseudo-ball-lattice-sol.yaml": "Anosov bundle, pseudo-balls (sol); target: 10",
    "ball-lattice-sol.yaml": "Anosov bundle (sol); target: 5 times pseudo-balls",
}


def ball_lattices(device: Device, repeat: int) -> None:
    """What nil, sl2 and sol cost against e3, in single precision and at the default width."""
    lanes = device.info.lane_width("single")
    contenders = [
        contender(device, file, name, "single", lanes, "auto") for file, name in BALL_LATTICES.items()
    ]
    race("lattices of balls, exact where not said, 1024 x 768, one light, no shadow", contenders, repeat)


# The geodesic flow of sol in a loop, by its closed form and by one step of Runge and Kutta's rule.
FLOWS = {
    "flow": "vector v = with_w(u, REAL(0)); flow(&p, &v, t); u = first_3(v)",
    "rk4": "motion y = {p, with_w(u, REAL(0))}; y = step_of(y, t); p = y.at; u = first_3(y.along)",
    "nothing": "u.x += t",
}
RK4 = ("flow/motion.h", "flow/field_left_invariant.h", "flow/rk4.h")
FLOW_KERNEL = """
__kernel void flow_{name}(__global const scalar *in, __global scalar *out, int stride, scalar time)
{{
  size_t packet = get_global_id(0);
  direction u = {{LOAD(packet, in), LOAD(packet, in + stride), LOAD(packet, in + 2 * stride)}};
  point p = origin();
  real t = REAL(time), sum = REAL(0);
  for (int i = 0; i < {loops}; i++) {{
    {statement};
    sum += p.x + u.x;
  }}
  STORE(sum, packet, out);
}}
"""
FLOW_RAYS, FLOW_LOOPS = 1 << 16, 16


def sol_flow(device: Device, repeat: int) -> None:
    """What one exact flow of sol costs in steps of RK4, for steps as rays take them and for a long one."""
    import pyopencl as cl

    lanes = device.info.lane_width("single")
    text = "".join(
        FLOW_KERNEL.format(name=name, loops=FLOW_LOOPS, statement=statement)
        for name, statement in FLOWS.items()
    )
    source = Source((*geometry_parts("sol"), *RK4, "flows"), generated={"flows": text})
    program, lanes = build_widest(device, source, "single", lanes)
    directions = np.random.default_rng(0).normal(size=(3, FLOW_RAYS)).astype(np.float32)
    directions /= np.linalg.norm(directions, axis=0)
    flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
    rays = cl.Buffer(device.context, flags, hostbuf=directions)
    ends = cl.Buffer(device.context, cl.mem_flags.WRITE_ONLY, directions[0].nbytes)
    print("\none flow of sol against one step of RK4, single precision, random directions")
    for time_step in (0.03, 0.3, 1.0, 3.0):
        seconds: dict[str, list[float]] = {name: [] for name in FLOWS}
        for _ in range(repeat + 1):
            for name in FLOWS:
                kernel = cl.Kernel(program, f"flow_{name}")
                kernel.set_args(rays, ends, np.int32(FLOW_RAYS), np.float32(time_step))
                before = time.process_time()
                cl.enqueue_nd_range_kernel(device.queue, kernel, (FLOW_RAYS // lanes,), (LOCAL_SIZE,)).wait()
                seconds[name].append(time.process_time() - before)
        loop = statistics.median(seconds["nothing"][1:])
        flow, rk4 = (statistics.median(seconds[name][1:]) - loop for name in ("flow", "rk4"))
        each = 1e9 / (FLOW_RAYS * FLOW_LOOPS)
        print(
            f"  time {time_step:4}: {flow * each:6.2f} core-ns a flow, {rk4 * each:5.2f} a step of RK4,"
            f" ratio {flow / rk4:5.2f}"
        )
    print("  target: at most 3")


# The short form of `thurston accuracy`: one time, one step, fewer directions, the groups.
SHORT_FORM: dict[str, Any] = {
    "geometries": ("nil", "sl2", "sol"),
    "times": (6.0,),
    "count": 2000,
    "steps": (0.1,),
}


def flows(device: Device) -> None:
    """Time against error of flows."""
    print("\nflows, a short form of `thurston accuracy`, whose head says what the columns are")
    print(table.text(list(protocol.measure(device=device, **SHORT_FORM))))


def ideal_cube(device: Device, repeat: int) -> None:
    """The ideal cube, complement of a ball, fog only: the scene of the paper's own shader."""
    lanes = device.info.lane_width("single")
    each = contender(device, "ideal-cube.yaml", "", "single", lanes, "auto")
    black = 0
    for tile in tiles((0, 0, *each.size), each.renderer.side):
        channels, _ = each.renderer.run(tile, sample_shifts(1), ["beauty"])
        black += int((channels["beauty"].max(axis=2) <= 0).sum())
    print(f"\nideal cube, 512 x 512, at most 100 steps: {black} black pixels, finish {each.renderer.finish}")


def memory() -> None:
    """Peak memory of a large picture, in a process of its own."""
    code = (
        "import json, resource, sys, thurston_cl as tc\n"
        "scene = tc.load_scene(sys.argv[1])\n"
        "image = tc.render(scene, size=(4096, 4096), samples=1)\n"
        "image.save(sys.argv[2], force=True)\n"
        "print(json.dumps(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss))\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", code, str(SCENES / "ideal-cube.yaml"), f"{folder}/large.exr"]
        kilobytes = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    print(f"\n4096 x 4096 with all channels, written as EXR: peak memory {kilobytes / 2**20:.2f} GiB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5, help="counted runs of each contender (default 5)")
    parser.add_argument("--device", help="as for `thurston render`")
    arguments = parser.parse_args()
    repeat = arguments.repeat
    device = devices.choose(arguments.device)
    info = device.info
    wide = info.lane_width("single")
    print(f"{info.name}, {info.platform_version}, {wide} lanes; medians of {repeat} runs in turn")
    half = max(1, wide // 2)
    for title, file in (
        ("hyperideal cube (h3), 1024 x 768, one light with hard shadow, fog", "hyperideal-cube.yaml"),
        ("ideal cube (h3), 512 x 512, complement of a ball, fog only, 100 steps", "ideal-cube.yaml"),
    ):
        ways = [
            (f"{wide} lanes, packet, single", "single", wide, "packet"),
            (f"{wide} lanes, refill, single", "single", wide, "refill"),
            (f"{half} lanes, packet, single", "single", half, "packet"),
            ("1 lane, packet, single", "single", 1, "packet"),
        ]
        if info.fp64:
            ways.append((f"{wide} lanes, packet, double", "double", info.lane_width("double"), "packet"))
        contenders = [contender(device, file, *way) for way in dict.fromkeys(ways)]
        race(title, contenders, repeat)
        print(f"  {TARGETS[file]}")
    ball_lattices(device, repeat)
    effects(device, repeat)
    unit_costs(device, repeat)
    sol_flow(device, repeat)
    if info.fp64:
        flows(device)
    krs(device, repeat, PLOT)
    ideal_cube(device, repeat)
    memory()


if __name__ == "__main__":
    main()
