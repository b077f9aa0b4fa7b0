"""What effects cost: each alone and some together against none, and against a program that has them all and
asks at run time which are on; and the unit costs from which `thurston explain` predicts.
"""

from race import Contender, contender, race

from thurston_cl.device import Device
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene.effect_files import EFFECTS

LIGHT = "lights.0.point"
TILE = "objects.0.material.color"
# By the name in effect_files.EFFECTS: the settings that add the effect to scenes/effects.yaml. In h3 there is
# no sun and no straight light; these two are measured in nil. What belongs to e3, or needs a view that is not
# closed by a cell, is measured there.
SETTINGS = {
    "checker": [f"{TILE}={{checker: {{count: 8}}}}"],
    "grid": [f"{TILE}={{grid: {{count: 8}}}}"],
    "bands": [f"{TILE}={{bands: {{count: 8}}}}"],
    "strips": [f"{TILE}={{strips: {{count: 8, colors: [red, white]}}}}"],
    "image": [f"{TILE}={{image: earth}}"],
    "noise": [f"{TILE}={{noise: {{octaves: 4}}}}"],
    "cell ids": ["outputs=[{file: ids.exr, channels: [beauty, cell]}]"],
    "light along all geodesics up to a length": [f"{LIGHT}.geodesics={{within: 9}}"],
    "light fading as 1/length": [f"{LIGHT}.falloff=inverse"],
    "light fading as 1/length²": [f"{LIGHT}.falloff=inverse-square"],
    "light that does not fade": [],
    "hard shadows": ["lights.0.shadows=hard"],
    "soft shadows": ["lights.0.shadows=soft"],
    "ambient occlusion": ["effects.ambient-occlusion.reach=0.4"],
    "exponential fog": ["effects.fog.exponential.density=0.2"],
    "linear fog": ["effects.fog.linear.length=12"],
    "fog between lights and surfaces": ["effects.fog={exponential: {density: 0.2}, on-lights: true}"],
    "reflections": ["objects.1.material.reflectivity=0.5", "effects.reflections.depth=2"],
}
IN_NIL = {
    "light along straight lines": "[{point: {at: [1, -1, 2], direction: straight}}]",
    "sun": "[{sun: {from: [0, 0, 1]}}]",
}
GROUND = "objects.1.material"
IN_E3 = {
    "sky": ["background={sky: {}}"],
    "noise": [f"{GROUND}={{color: {{noise: {{octaves: 4}}}}}}"],
    "triplanar": [f"{GROUND}={{color: {{triplanar: {{checker: {{}}}}}}}}"],
    "slope": [f"{GROUND}={{color: {{slope: {{flat: green, steep: gray}}}}}}"],
}
# Beside the effects: what lights ask for more.
MORE = {
    "light as the geometry makes it (area density)": [f"{LIGHT}.falloff=area"],
    "light from the neighbours too": [f"{LIGHT}.translates=neighbours"],
    "a ball at the light": [f"{LIGHT}.ball=0.05"],
}
# One of each kind: of two falloffs, fogs, patterns or shadows a light or surface has one.
TOGETHER = {
    "image",
    "cell ids",
    "light along all geodesics up to a length",
    "soft shadows",
    "ambient occlusion",
    "fog between lights and surfaces",
    "reflections",
    "light as the geometry makes it (area density)",
}


def effects(device: Device, repeat: int) -> None:
    """Print the cost of each effect, and what assembling saves."""
    lanes = device.info.lane_width("single")

    def each(name: str, sets: list[str], switch: bool | None = None) -> Contender:
        return contender(device, "effects.yaml", name, "single", lanes, "packet", sets=sets, switch=switch)

    missing = set(EFFECTS) - set(SETTINGS) - set(IN_NIL) - set(IN_E3)
    assert not missing, f"effects without a benchmark: {missing}"
    alone = SETTINGS | MORE
    together = [setting for name, sets in alone.items() if name in TOGETHER for setting in sets]
    contenders = [each("none: one light that does not fade", [])]
    contenders += [each(name, sets) for name, sets in alone.items() if sets]
    contenders += [each("together, one of each kind", together)]
    race("effects, each alone and all together; Seifert-Weber space (h3), 768 x 432", contenders, repeat)
    print(f"  together: {', '.join(sorted(TOGETHER))}")
    width, height = contenders[0].size
    print(f"  {'':50} {'shadow':>9} {'mirror':>7} {'solves':>6} {'distances':>10}  per first ray")
    for one in contenders:
        shadow, mirror, solves, distances = (
            one.work[name] / (width * height)
            for name in ("shadow_steps", "reflection_steps", "light_solves", "distance_evaluations")
        )
        print(f"  {one.name:50} {shadow:9.2f} {mirror:7.2f} {solves:6.2f} {distances:10.2f}")
    nil = [("light along its geodesic", "[{point: {at: [1, -1, 2], falloff: constant}}]"), *IN_NIL.items()]
    race(
        "light in nil",
        [
            contender(
                device,
                "unit-costs.yaml",
                name,
                "single",
                lanes,
                "packet",
                sets=["geometry=nil", f"lights={lights}"],
            )
            for name, lights in nil
        ],
        repeat,
    )
    flat = [("none", []), *IN_E3.items()]
    race(
        "what belongs to e3, over a ball and a plane",
        [
            contender(device, "unit-costs.yaml", name, "single", lanes, "packet", sets=sets)
            for name, sets in flat
        ],
        repeat,
    )
    # What has no switch is in all of these.
    unswitched = ("image", "cell ids", "light along all geodesics up to a length")
    light = [setting for name in unswitched for setting in SETTINGS[name]]
    light += MORE["light as the geometry makes it (area density)"]
    assembled = [
        each("assembled: image, cell ids and light alone", light),
        each("everything compiled, the rest switched off", together, False),
        each("everything compiled, switched on", together, True),
        each("assembled: everything", together),
    ]
    race("what assembling saves: effects that are compiled but off", assembled, repeat)


def unit_costs(device: Device, repeat: int) -> None:
    """What a light costs in steps of a ray, by geometry: its solve, and its solve with the area density."""
    lanes = device.info.lane_width("single")
    print("\nunit costs, in steps of a ray over a ball and a plane; see thurston_cl/scene/cost.py")
    for geometry in GEOMETRIES:
        lights = {
            "one": "[{point: {at: [1, -1, 2], falloff: constant}}]",
            "more": "[" + ", ".join(["{point: {at: [1, -1, 2], falloff: constant}}"] * 9) + "]",
            "area": "[" + ", ".join(["{point: {at: [1, -1, 2]}}"] * 9) + "]",
        }
        ways = [
            contender(
                device,
                "unit-costs.yaml",
                name,
                "single",
                lanes,
                "packet",
                sets=[f"geometry={geometry}", f"lights={text}"],
            )
            for name, text in lights.items()
        ]
        for _ in range(repeat + 1):
            for way in ways:
                way.run()
        one, more, area = (way.median for way in ways)
        solves = ways[0].work["light_solves"]
        step = (one - (more - one) / 8) / ways[0].work["steps"]
        solve = (more - one) / (8 * solves) / step
        density = (area - more) / (9 * solves) / step
        costs = f"solve {solve:5.2f} steps, area density {density:5.2f}"
        print(f"  {geometry:5} {1e9 * step:6.1f} core-ns a step; {costs}")
