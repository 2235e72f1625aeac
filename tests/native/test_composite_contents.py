"""What is in the file of a composite besides the library: names, descriptions, icon, pages."""

from __future__ import annotations

import cmath
import math
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple
from fmpy.validation import validate_fmu
from lxml import etree

from autobalancer.fmus.composite.build import build_composite
from autobalancer.fmus.unit import LONGEST_NAME
from autobalancer.harness import load_scene
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.harness.export.reference_files import FOLDER
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.result.verdict import BALANCED
from autobalancer.models.linear.synchronous import synchronous

SCENES = ["two_balls", "sommerfeld"]


def built(folder: Path, name: str, fmi: int = 2, **form) -> Path:
    path = folder / f"{name}.fmu"
    return build_one_file(load_scene(name), path, fmi, [platform_tuple], **form)


@pytest.mark.parametrize(("name", "fmi"), [("two_balls", 2), ("sommerfeld", 3)])
def test_every_variant_of_the_file_is_valid_and_runs_alike(tmp_path, name, fmi):
    seen = []
    for form in ({}, {"plain": True}, {"flat": True}, {"plain": True, "flat": True}):
        path = built(tmp_path, name, fmi, **form)
        assert validate_fmu(str(path)) == []
        variables = fmpy.read_model_description(str(path), validate=True).modelVariables
        names = [v.name for v in variables]
        assert max(map(len, names)) <= LONGEST_NAME
        assert not any(n.endswith(("track_mobility", "shortest_stopped_step")) for n in names)
        slopes = [v for v in variables if "der" in v.name and v.causality == "output"]
        assert bool(slopes) == ("plain" not in form)
        assert all(n.isidentifier() for n in names) == ("flat" in form)
        shown = "rotor_plane_1_x" if "flat" in form else "rotor.plane[1].x"
        seen.append(fmpy.simulate_fmu(str(path), stop_time=0.1, output=[shown])[shown])
    assert all((found == seen[0]).all() for found in seen)


def test_descriptions_stand_alone(tmp_path):
    """They begin with what is measured, not with "Of the rotor", and no two inputs share one."""
    description = fmpy.read_model_description(str(built(tmp_path, "two_balls")))
    texts = [v.description for v in description.modelVariables]
    assert not [text for text in texts if text.split()[0] in ("Of", "Along", "In", "On", "With")]
    assert load_scene("two_balls").heading in description.description


def test_names_that_are_too_long_for_matlab_are_refused(tmp_path):
    made = replace(composition(load_scene("two_balls")), flat=True).described("one")
    assert made.label("der(rotor.plane[1].a_xi)") == "der_rotor_plane_1_a_xi"
    made = composition(load_scene("two_balls"))
    rotor, weights = made.parts
    long = replace(made, parts=(rotor, replace(weights, name="b" * 60)))
    with pytest.raises(ValueError, match="characters, and MATLAB allows 63"):
        build_composite(long, tmp_path, name="one")


UNEQUAL = {"mass": [0.13, 0.24, 0.31], "weight_radius": [0.01, 0.013, 0.015]}


@pytest.mark.parametrize(
    ("name", "weights"),
    [("finite_weights", {}), ("finite_weights", UNEQUAL), ("three_mass_shaft", {})],
    ids=["equal", "unequal", "shaft"],
)
def test_the_file_says_what_is_left_of_vibration_and_unbalance(hosted, name, weights):
    """Against the motion of the last revolution, the angles, and Goncharov's capacity."""
    scene = load_scene(name)
    scene = scene.replace({f"balls.{key}": value for key, value in weights.items()})
    host = hosted(scene)
    turn, many = 2.0 * math.pi / scene.profile().end, 400
    limit = host.get("vibration_limit")[0]
    rows = []
    names = [v.name for v in host.description.modelVariables]
    axes = [n for n in names if re.fullmatch(r"rotor\.(station\[\d\]\.)?[xy]", n)]
    flag = [v.valueReference for v in host.description.modelVariables if v.name == "balanced"]
    assert host.slave.getBoolean(flag) == [False]
    for _ in range(8):
        rows = [host.step(turn / many) or host.get(*axes) for _ in range(many)]
    host.step(turn / 16)  # looks at the motion are 1/32 of a turn apart
    vibration, left, used = host.get("vibration", "residual_unbalance", "capacity_used")
    assert vibration == pytest.approx(0.5 * np.ptp(np.array(rows), axis=0).max(), rel=0.05)
    assert host.slave.getBoolean(flag) == [vibration <= limit]
    moments = [
        complex(*host.get(f"{one.label}.moment_xi", f"{one.label}.moment_eta"))
        for one in scene.balancer
    ]
    shares = [abs(m) / one.capacity for m, one in zip(moments, scene.balancer, strict=True)]
    assert used == pytest.approx(max(shares), rel=1e-9)
    amounts = [n for n in names if re.fullmatch(r"rotor\.unbalance(\[\d\]\.amount)?", n)]
    turned = [n.replace(".amount", ".angle") if "[" in n else f"{n}_angle" for n in amounts]
    own = map(cmath.rect, host.get(*amounts), host.get(*turned))
    assert left == pytest.approx(abs(sum(own) + sum(moments)), rel=1e-9)


def test_a_machine_that_nothing_holds_is_balanced_though_it_drifts(hosted):
    """Against the amplitude that turns with the rotor over many revolutions, by least squares."""
    scene = load_scene("angle_grinder")
    host = hosted(scene)
    turn, many = 2.0 * math.pi / scene.profile().end, 16
    flag = [v.valueReference for v in host.description.modelVariables if v.name == "balanced"]
    names = [v.name for v in host.description.modelVariables]
    axes = [n for n in names if re.fullmatch(r"rotor\.(station\[\d\]\.|body\[\d\]\.)?[xy]", n)]
    limit = host.get("vibration_limit")[0]
    host.step(20 * turn)
    early, drift = host.get("vibration")[0], np.array(host.get(*axes))
    assert host.slave.getBoolean(flag) == [False]
    assert early > limit
    host.step(180 * turn)
    rows = [host.step(turn / many) or host.get(*axes) for _ in range(100 * many)]
    angle = 2.0 * math.pi / many * np.arange(len(rows))
    turning = synchronous(angle, np.array(rows).T, drifts=True)
    late = host.get("vibration")[0]
    assert np.abs(np.array(rows[-1]) - drift).max() > 1e3 * limit
    assert late == pytest.approx(np.abs(turning).max(), abs=0.2 * limit)
    assert host.slave.getBoolean(flag) == [True]


def test_vibration_of_a_free_machine_without_balancers_is_the_closed_form(hosted):
    scene = load_scene("angle_grinder").without_balancers()
    host = hosted(scene)
    host.step(50 * 2.0 * math.pi / scene.profile().end)
    vibration, limit = host.get("vibration", "vibration_limit")
    assert vibration == pytest.approx(limit / BALANCED, rel=0.01)


@pytest.mark.parametrize("name", SCENES)
def test_a_terminal_a_plane_names_variables_that_there_are(tmp_path, name):
    path = built(tmp_path, name, 3)
    with zipfile.ZipFile(path) as archive:
        text = archive.read("terminalsAndIcons/terminalsAndIcons.xml")
        assert archive.read("terminalsAndIcons/icon.png")[:4] == b"\x89PNG"
    schema = Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"
    root = etree.fromstring(text)
    etree.XMLSchema(file=str(schema)).assertValid(root)
    names = {v.name for v in fmpy.read_model_description(str(path)).modelVariables}
    assert {v.get("variableName") for v in root.iter("TerminalMemberVariable")} <= names
    planes = composition(load_scene(name)).sizes.planes
    assert len(root.findall("Terminals/Terminal")) == planes


@pytest.mark.parametrize("name", SCENES)
def test_the_documentation_shows_this_machine(tmp_path, name):
    """Sketch, values in the units of drawings, and lines that run as printed."""
    scene, path = load_scene(name), built(tmp_path, name)
    with zipfile.ZipFile(path) as archive:
        page = archive.read("documentation/index.html").decode()
    etree.fromstring(page[page.index("<svg") : page.index("</svg>") + 6])
    assert scene.source.split()[0] in page
    assert all(f">{balancer.label}</text>" in page for balancer in scene.balancer)
    assert " rpm</td>" in page
    lines = page[page.index("<pre>") + 5 : page.index("</pre>")].replace("&quot;", '"')
    kept = [line for line in lines.splitlines() if "plot" not in line]
    assert 'output=["rotor.' in lines
    code = "\n".join(["from fmpy import simulate_fmu", *kept]).replace(f"{name}.fmu", str(path))
    exec(code.replace("stop_time=", "stop_time=0.01*"), {})


@pytest.mark.parametrize("form", [{}, {"flat": True, "fmi": 3}], ids=["FMI 2", "flat, FMI 3"])
def test_the_reference_inside_is_what_the_file_computes(tmp_path, form):
    """By FMI-LS-REF: the manifest names a table, and a tight run has its values."""
    scene = load_scene("two_balls")
    told = []
    path = build_one_file(
        scene, tmp_path / "one.fmu", platforms=[platform_tuple], reference=True,
        progress=told.append, **form,
    )  # fmt: skip
    assert told[0] == 0.0
    assert 0.9 < told[-1] <= 1.0
    assert any(0.4 < share < 0.6 for share in told)
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        manifest = etree.fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
        related = manifest.find("Related")
        assert related.get("role") == "result"
        table = archive.read(f"{FOLDER}/{related.get('source')}").decode()
    names, *rows = [line.split(",") for line in table.splitlines()]
    expected = np.array(rows, float)
    step, end = expected[1, 0], expected[-1, 0]
    run = fmpy.simulate_fmu(
        str(path),
        stop_time=end,
        output_interval=step,
        output=names[1:],
        start_values={"coupling_tolerance" if "flat" in form else "coupling.tolerance": 1e-11},
    )
    found = np.array([run[name] for name in names[1:]]).T
    assert found.shape == expected[:, 1:].shape
    assert np.abs(found - expected[:, 1:]).max() < 1e-7 * np.abs(expected[:, 1:]).max()
