"""`thurston accuracy`: options, messages, exit codes, and what an interrupt leaves. A fake measures."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from accuracy_rows import rows
from click.testing import CliRunner, Result

from thurston_cl import device
from thurston_cl.accuracy import directions, plot, protocol
from thurston_cl.cli import accuracy as module
from thurston_cl.cli import accuracy_scene
from thurston_cl.cli.main import main
from thurston_cl.models import GEOMETRIES


class FakeMeasure:
    """Stands in for `protocol.measure`: notes what it was asked for, and gives four rows."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.interrupt_at = 5

    def __call__(self, *arguments: Any, progress: Any) -> Iterator[protocol.Row]:
        self.calls.append(arguments)
        for done, row in enumerate(rows()):
            progress(done, 4, "nil: what comes next")
            if done == self.interrupt_at:
                raise KeyboardInterrupt
            yield row
        progress(4, 4, "")


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> FakeMeasure:
    measure = FakeMeasure()
    monkeypatch.setattr(protocol, "measure", measure)
    info = SimpleNamespace(name="Toaster", id="0:0", fp64=True)
    monkeypatch.setattr(device, "choose", lambda name: SimpleNamespace(info=info))
    return measure


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["accuracy", *arguments])


def test_defaults_are_those_of_the_protocol(fake: FakeMeasure) -> None:
    assert (module.TIMES, module.STEPS, module.DIRECTIONS) == (
        protocol.TIMES,
        protocol.STEPS,
        protocol.DIRECTIONS,
    )
    result = run()
    assert result.exit_code == 0, result.stderr
    assert fake.calls[0][:4] == (GEOMETRIES, (6.0, 10.0), 10_000, (0.1, 0.01))
    assert "truth     double exact" in result.stdout
    assert f"seed {directions.SEED}" in result.stdout
    assert "nil, t = 6, 100 uniform directions" in result.stdout
    assert result.stderr.splitlines()[0] == "nil: 0 of 4 rows are finished"
    assert result.stderr.splitlines()[-1].startswith("measured 4 rows in ")


def test_options(fake: FakeMeasure) -> None:
    result = run(
        "--geometry", "sol", "--geometry", "e3", "--times", "1, 2.5", "--steps=.5", "--directions=7", "-q"
    )
    assert result.exit_code == 0
    assert fake.calls[0][:4] == (("sol", "e3"), (1.0, 2.5), 7, (0.5,))
    assert result.stderr == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--times", "6,x"], "Invalid value for '--times': 'x' is not a length over 0, up to 100"),
        (["--times", "nan"], "'nan' is not a length over 0, up to 100"),
        (["--times", "101"], "'101' is not a length over 0, up to 100"),
        (["--times", "6,6.0"], "6.0 is given twice"),
        (["--times", ""], "'' is not a length over 0"),
        (["--steps", "0.1,-1"], "Invalid value for '--steps': '-1' is not a length over 0, up to 100"),
        (["--steps", "1e-6"], "--steps 1e-06 makes 1e+07 steps to 10; at most 100000 are made"),
        (["--directions", "0"], "0 is not in the range 1<=x<=100000"),
        (["--geometry", "e4"], "'e4' is not one of 'e3', 's3'"),
        (["--plot", "a.jpg"], "'a.jpg' does not end in .png, .svg, .pdf"),
        (["--json", "--csv"], "--json and --csv are two ways to print the same: leave out one"),
        (["--set", "render.samples=4"], "--set is for a scene: name one"),
        (["-D", "r=4"], "-D is for a scene: name one"),
        (["--size", "32x18"], "--size is for a scene: name one"),
        (["some.yaml", "--times", "6"], "--times is for flows without a scene: leave out it or some.yaml"),
    ],
)
def test_wrong_usage(fake: FakeMeasure, arguments: list[str], message: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())
    assert fake.calls == []


def test_json_and_csv(fake: FakeMeasure) -> None:
    answer = json.loads(run("--json").stdout)
    assert (answer["device"], answer["directions"], answer["times"]) == ("Toaster", 10_000, [6.0, 10.0])
    assert answer["complete"] is True
    assert len(answer["rows"]) == 4
    assert len(list(csv.DictReader(io.StringIO(run("--csv").stdout)))) == 4


@pytest.mark.parametrize(
    ("at", "said"), [(2, "2 of 4 rows are finished and printed"), (0, "0 of 4 rows are finished")]
)
def test_an_interrupt_prints_what_is_finished(fake: FakeMeasure, at: int, said: str, tmp_path: Path) -> None:
    fake.interrupt_at = at
    result = run("--json", "--plot", str(tmp_path / "a.png"))
    assert result.exit_code == 130
    assert result.stderr.endswith(f"thurston: interrupted: {said}\n")
    answer = json.loads(result.stdout)
    assert (len(answer["rows"]), answer["complete"]) == (at, False)
    assert list(tmp_path.iterdir()) == []
    assert ("nil, t = 6" in run().stdout) == (at > 0)


def test_the_plot_is_whole_or_absent(
    fake: FakeMeasure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "a.png"
    result = run("--plot", str(file))
    assert result.exit_code == 0
    assert result.stderr.splitlines()[-1].endswith(f"drawn in {file}")
    first = file.read_bytes()
    assert first[:4] == b"\x89PNG"
    kept = run("--plot", str(file))
    assert (kept.exit_code, len(fake.calls)) == (73, 1)
    assert kept.stderr == f"thurston: error: {file}: exists; use --force to replace it\n"
    assert run("--plot", str(file), "--force").exit_code == 0

    def fail(rows: Any, part: str) -> None:
        Path(part).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(plot, "plot", fail)
    full = run("--plot", str(file), "--force")
    assert (full.exit_code, file.read_bytes()[:4]) == (73, b"\x89PNG")
    assert f"{file}: cannot be written: No space left on device" in full.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
    assert "exact" in full.stdout  # the rows are not lost with it


def test_what_is_missing_is_said_before_the_work(
    fake: FakeMeasure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    nowhere = run("--plot", str(tmp_path / "no" / "a.png"))
    assert (nowhere.exit_code, nowhere.stderr) == (
        73,
        f"thurston: error: {tmp_path}/no/a.png: there is no directory {tmp_path}/no\n",
    )
    monkeypatch.setattr(plot, "has_matplotlib", lambda: False)
    missing = run("--plot", "a.png")
    assert missing.exit_code == 1
    assert (
        "--plot needs matplotlib, which is not installed; pip install 'thurston_cl[plot]'" in missing.stderr
    )
    info = SimpleNamespace(name="Toaster", id="0:0", fp64=False)
    monkeypatch.setattr(device, "choose", lambda name: SimpleNamespace(info=info))
    single = run()
    assert single.exit_code == 69
    assert "Toaster (0:0) has no double precision, which errors are measured against" in single.stderr
    assert fake.calls == []


def test_a_scene_is_reported_on_with_what_is_said_of_it(
    fake: FakeMeasure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[tuple[str, dict[str, Any]]] = []
    monkeypatch.setattr(accuracy_scene, "report_scene", lambda name, **said: calls.append((name, said)))
    file = tmp_path / "a.png"
    result = run("some.yaml", "--size", "32x18", "-D", "r=1", "--json", "-q", "--plot", str(file))
    assert result.exit_code == 0, result.stderr
    ((name, said),) = calls
    draw = said.pop("draw")
    assert name == "some.yaml"
    assert said == {
        "defines": {"r": "1"},
        "sets": (),
        "as_json": True,
        "as_csv": False,
        "device": None,
        "quiet": True,
        "size": (32, 18),
    }
    draw(lambda part: Path(part).write_bytes(b"drawn"))
    assert file.read_bytes() == b"drawn"
    run("some.yaml")
    assert calls[1][1]["draw"] is None
    assert fake.calls == []
