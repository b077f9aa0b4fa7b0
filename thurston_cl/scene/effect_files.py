"""What a scene may call for, each in a kernel file of its own that is pasted only then."""

from collections.abc import Collection

# By name: the file, in order of pasting.
EFFECTS = {
    "checker": "pattern/checker.h",
    "grid": "pattern/grid.h",
    "bands": "pattern/bands.h",
    "strips": "pattern/strips.h",
    "image": "pattern/image.h",
    "noise": "pattern/noise.h",
    "triplanar": "pattern/triplanar.h",
    "slope": "pattern/slope.h",
    "cell ids": "cells.h",
    "light along straight lines": "light/direction_field.h",
    "sun": "light/sun.h",
    "light along all geodesics up to a length": "light/within.h",
    "light fading as 1/length": "light/falloff_inverse.h",
    "light fading as 1/length²": "light/falloff_inverse_square.h",
    "light that does not fade": "light/falloff_constant.h",
    "hard shadows": "light/hard_shadow.h",
    "soft shadows": "light/soft_shadow.h",
    "ambient occlusion": "light/ambient_occlusion.h",
    "exponential fog": "light/fog_exponential.h",
    "linear fog": "light/fog_linear.h",
    "fog between lights and surfaces": "light/light_in_fog.h",
    "sky": "light/sky.h",
    "reflections": "light/reflection.h",
}

# Files of light/ that several effects share, in order of pasting; phong.h comes before them.
SUPPORT = (
    "light/point.h",
    "light/falloff_area.h",
    "light/lifted_ray.h",
    "light/shadow_ray.h",
    "light/shadow_to_light.h",
    "light/shadow_to_sun.h",
    "light/fog.h",
)

# Files of pattern/ that several patterns share; they come before the others.
PATTERN_SUPPORT = ("pattern/color_in_turn.h", "pattern/footprint.h")

# These follow the text of the scene's own light.
AFTER_LIGHT = ("light/look.h", "light/reflection.h")


def light_parts(parts: Collection[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Those of `parts` that stand before and after the text of the scene's own light, in order."""
    before = [file for file in (*SUPPORT, *EFFECTS.values()) if file in parts and file.startswith("light/")]
    after = [file for file in AFTER_LIGHT if file in parts]
    return ("light/phong.h", *(file for file in before if file not in after)), tuple(after)


def called_for(parts: Collection[str]) -> list[str]:
    """Effects whose files are among `parts`."""
    return [effect for effect, file in EFFECTS.items() if file in parts]


def left_out(parts: Collection[str]) -> list[str]:
    """Effects that exist, and whose files are not among `parts`."""
    return [effect for effect, file in EFFECTS.items() if file not in parts]
