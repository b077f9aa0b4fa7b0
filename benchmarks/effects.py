"""What effects cost: each alone and some together against none, and against a program that has them all and
asks at run time which are on; and the unit costs from which `thurston explain` predicts.
"""

from race import Contender, contender, race

from thurston_cl.device import Device
from thurston_cl.models import GEOMETRIES

LIGHT = "lights.0.point"
# By name: the settings that add the effect to scenes/effects.yaml.
EFFECTS = {
    "hard shadows": ["lights.0.shadows=hard"],
    "soft shadows": ["lights.0.shadows=soft"],
    "light fading as the geometry makes it": [f"{LIGHT}.falloff=area"],
    "light fading as 1/length": [f"{LIGHT}.falloff=inverse"],
    "light from the neighbours too": [f"{LIGHT}.translates=neighbours"],
    "a ball at the light": [f"{LIGHT}.ball=0.05"],
    "exponential fog": ["effects.fog.exponential.density=0.2"],
    "linear fog": ["effects.fog.linear.length=12"],
    "fog, and between lights and surfaces": ["effects.fog={exponential: {density: 0.2}, on-lights: true}"],
    "ambient occlusion": ["effects.ambient-occlusion.reach=0.4"],
    "one reflection": ["objects.1.material.reflectivity=0.5", "effects.reflections.depth=1"],
    "two reflections": ["objects.1.material.reflectivity=0.5", "effects.reflections.depth=2"],
    "checker": ["objects.0.material.color={checker: {count: 8}}"],
}
TOGETHER = (
    "soft shadows",
    "light fading as the geometry makes it",
    "fog, and between lights and surfaces",
    "ambient occlusion",
    "two reflections",
)


def effects(device: Device, repeat: int) -> None:
    """Print the cost of each effect, and what assembling saves."""
    lanes = device.info.lane_width("single")

    def each(name: str, sets: list[str], switch: bool | None = None) -> Contender:
        return contender(device, "effects.yaml", name, "single", lanes, "packet", sets=sets, switch=switch)

    together = [setting for name in TOGETHER for setting in EFFECTS[name]]
    # With the light that all effects together have, so that the switches are all that differs.
    light = EFFECTS["light fading as the geometry makes it"]
    contenders = [each("none: one light that does not fade", [])]
    contenders += [each(name, sets) for name, sets in EFFECTS.items()]
    contenders += [each(f"together: {', '.join(TOGETHER)}"[:50], together)]
    race("effects, each alone and some together; Seifert-Weber space (h3), 768 x 432", contenders, repeat)
    width, height = contenders[0].size
    print(f"  {'':50} {'shadow':>9} {'mirror':>7} {'solves':>6} {'distances':>10}  per first ray")
    for one in contenders:
        shadow, mirror, solves, distances = (
            one.work[name] / (width * height)
            for name in ("shadow_steps", "reflection_steps", "light_solves", "distance_evaluations")
        )
        print(f"  {one.name:50} {shadow:9.2f} {mirror:7.2f} {solves:6.2f} {distances:10.2f}")
    assembled = [
        each("assembled: that light alone", light),
        each("everything compiled, switched off", together, False),
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
