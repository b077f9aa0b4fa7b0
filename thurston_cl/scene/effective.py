"""The text of a scene with -D and --set worked in, for the metadata of a picture."""

import io

from ruamel.yaml import YAML

from .overrides import change, read_overrides
from .source import SceneSource


def effective_text(source: SceneSource) -> str:
    """YAML that gives the same scene without options. Keeps comments, and untouched scenes as they are."""
    overrides = read_overrides(source.defines, source.sets)
    if not overrides.defines and not overrides.sets:
        return source.text
    yaml = YAML(typ="rt", pure=True)
    yaml.preserve_quotes = True
    yaml.width = 1 << 20  # never wrap a line that its author did not
    yaml.indent(mapping=2, sequence=4, offset=2)
    data = yaml.load(source.text)
    for _, keys, value in overrides.sets:
        change(data, keys, value.data)
    for name, define in overrides.defines.items():
        data["params"][name] = define
    stream = io.StringIO()
    yaml.dump(data, stream)
    return stream.getvalue()
