"""FMI 3.0 with arrays: the same units, with one value reference for a row of scalars."""

from __future__ import annotations

import ctypes
import math
import re

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from autobalancer.fmus.build import build, contents
from autobalancer.fmus.xml.arrays import arrays, as_one
from autobalancer.fmus.xml.fmi3 import value_references

BALLS, ROTOR = "BallBalancer", "RotorOnSupports"
SHAPES = [
    (ROTOR, {"planes": 3}),
    (ROTOR, {"kind": "two_support", "stations": 2, "planes": 2, "unbalances": 2}),
    (ROTOR, {"kind": "flexible", "stations": 4, "shaft": "compliance", "planes": 2}),
    ("LiquidBalancer", {}),
    (BALLS, {"weights": 4, "frame": "fixed"}),
]
shapes = pytest.mark.parametrize(("unit", "options"), SHAPES)


class Host:
    """An instance of the library under FMI 3.0, with or without arrays."""

    def __init__(self, fmus, unit: str, with_arrays: bool, **options: object) -> None:
        layout = fmus.layout(unit, **options)
        rows = arrays(layout) if with_arrays else [(v,) for v in layout.variables]
        references = value_references(layout)
        self.elements = {as_one(row).name: [v.name for v in row] for row in rows}
        self.reference = {as_one(row).name: references[row[0].name] for row in rows}
        self.reference["time"] = references["time"]
        self.elements["time"] = ["time"]
        self.causality = {as_one(row).name: row[0].causality for row in rows if not row[0].boolean}
        self.messages: list[str] = []
        self.slave = FMU3Slave(
            guid=fmus.token(unit, arrays=with_arrays, **options),
            unzipDirectory=str(fmus.unpacked),
            modelIdentifier="autobalancer",
            instanceName="unit",
        )
        self.slave.instantiate(
            logMessage=lambda _e, _s, _c, text: self.messages.append(text.decode())
        )

    def begin(self, values: dict[str, float]) -> Host:
        self.slave.enterInitializationMode()
        self.set(values)
        self.slave.exitInitializationMode()
        return self

    def names(self, *causalities: str) -> list[str]:
        return [name for name, causality in self.causality.items() if causality in causalities]

    def scalars(self, names: list[str]) -> list[str]:
        return [element for name in names for element in self.elements[name]]

    def set(self, values: dict[str, float]) -> None:
        """Values of all elements, by the elements' names, in one call."""
        names = [name for name, row in self.elements.items() if row[0] in values]
        ordered = [values[element] for element in self.scalars(names)]
        self.slave.setFloat64([self.reference[name] for name in names], ordered)

    def get(self, names: list[str]) -> dict[str, float]:
        """Elements by name, read in one call."""
        listed = self.scalars(names)
        references = [self.reference[name] for name in names]
        return dict(zip(listed, self.slave.getFloat64(references, len(listed)), strict=True))

    def refused(self, call) -> str:
        before = len(self.messages)
        with pytest.raises(FMICallException):
            call()
        return self.messages[before]


@pytest.fixture
def host(fmus):
    made: list[Host] = []

    def make(unit: str, with_arrays: bool, values: dict | None = None, **options: object) -> Host:
        made.append(Host(fmus, unit, with_arrays, **options).begin(values or {}))
        return made[-1]

    yield make
    for one in made:
        one.slave.fmi3FreeInstance(one.slave.component)


def both(host, unit: str, values: dict | None = None, **options: object) -> tuple[Host, Host]:
    """With scalars, and with arrays."""
    return host(unit, False, values, **options), host(unit, True, values, **options)


def moved(plain: Host, rows: Host) -> list[str]:
    """Make a step with inputs that are all different; the inputs' names."""
    inputs = plain.names("input")
    values = {name: 1.0 + k / 9 for k, name in enumerate(inputs)}
    for one in (plain, rows):
        one.set(values)
        one.slave.doStep(0.0, 1e-3)
    return inputs


@shapes
def test_arrays_have_the_bits_of_their_scalars(host, unit, options):
    plain, rows = both(host, unit, **options)
    moved(plain, rows)
    everything = ["time", *rows.names("parameter", "input", "output"), "time"]
    found = rows.get(everything)
    assert found == plain.get(rows.scalars(everything))
    assert found["time"] == 1e-3


@shapes
def test_directional_derivatives_take_and_give_whole_arrays(host, unit, options):
    plain, rows = both(host, unit, **options)
    moved(plain, rows)
    inputs, outputs = rows.names("input"), rows.names("output")
    seed = [1.0 + k * k for k in range(len(rows.scalars(inputs)))]
    found = [
        one.slave.getDirectionalDerivative(
            [one.reference[name] for name in unknowns],
            [one.reference[name] for name in knowns],
            seed,
            len(rows.scalars(outputs)),
        )
        for one, unknowns, knowns in (
            (rows, outputs, inputs),
            (plain, rows.scalars(outputs), rows.scalars(inputs)),
        )
    ]
    assert found[0] == found[1]
    assert any(found[0])


@shapes
def test_adjoint_derivatives_are_the_directional_ones_read_backwards(host, unit, options):
    plain, rows = both(host, unit, **options)
    moved(plain, rows)
    inputs, outputs = rows.names("input"), rows.names("output")
    rng = np.random.default_rng(3)
    forward = rng.uniform(-1.0, 1.0, len(rows.scalars(inputs)))
    backward = rng.uniform(-1.0, 1.0, len(rows.scalars(outputs)))
    unknowns, knowns = ([rows.reference[name] for name in names] for names in (outputs, inputs))
    change = rows.slave.getDirectionalDerivative(unknowns, knowns, forward, len(backward))
    found = np.array(rows.slave.getAdjointDerivative(unknowns, knowns, backward, len(forward)))
    terms = backward * change
    assert found @ forward == pytest.approx(terms.sum(), abs=1e-13 * np.abs(terms).sum())
    assert np.abs(found).max() > 0
    scalar = [[plain.reference[n] for n in rows.scalars(names)] for names in (outputs, inputs)]
    assert plain.slave.getAdjointDerivative(*scalar, backward, len(forward)) == found.tolist()
    count = len(backward)
    text = rows.refused(lambda: rows.slave.getAdjointDerivative(knowns, unknowns, forward, count))
    assert "an adjoint derivative failed: knowns must be inputs" in text


def slopes(one: Host, names: list[str], orders: list[int], count: int) -> list[float]:
    values = (ctypes.c_double * count)()
    references = (ctypes.c_uint * len(names))(*[one.reference[name] for name in names])
    listed = (ctypes.c_int * len(names))(*orders)
    one.slave.fmi3GetOutputDerivatives(
        one.slave.component, references, len(names), listed, values, count
    )
    return list(values)


def test_an_order_goes_for_a_whole_array(host):
    plain, rows = both(host, ROTOR, planes=2)
    moved(plain, rows)
    names = ["plane.a_xi", "x", "plane.y", "plane.a_xi"]
    listed = rows.scalars(names)
    assert slopes(rows, names, [1] * 4, 7) == slopes(plain, listed, [1] * 7, 7)
    text = rows.refused(lambda: slopes(rows, names, [1, 1, 2, 1], 7))
    assert "plane[1].y: the order of an output's derivative must be 1" in text


def test_arrays_of_parameters_are_set_before_the_start(host):
    start = {f"weight[{k}].angle0": 0.3 * k * k for k in (1, 2, 3)}
    plain, rows = both(host, BALLS, start, weights=3)
    names = ["weight.angle", "weight.speed", "F_xi"]
    assert rows.get(names) == plain.get(rows.scalars(names))
    assert rows.get(["weight.angle"])["weight[3].angle"] == start["weight[3].angle0"]


def test_a_state_is_taken_back_and_that_of_scalars_refused(host):
    plain, rows = both(host, BALLS, weights=3)
    moved(plain, rows)
    outputs = rows.names("output")
    expected = rows.get(outputs)
    saved, other = (one.slave.getFMUState() for one in (rows, plain))
    data, foreign = rows.slave.serializeFMUState(saved), plain.slave.serializeFMUState(other)
    rows.slave.doStep(1e-3, 1e-3)
    assert rows.get(outputs) != expected
    text = rows.refused(lambda: rows.slave.deserializeFMUState(foreign))
    assert "not to 'BallBalancer/arrays=true/frame=rotor/weights=3/" in text
    rows.slave.setFMUState(rows.slave.deserializeFMUState(data))
    assert rows.get(outputs) == expected
    rows.slave.freeFMUState(saved)
    plain.slave.freeFMUState(other)


# --- what is refused ----------------------------------------------------------------------------


def test_a_wrong_element_is_named_and_no_element_is_set(host, fmus):
    one = Host(fmus, BALLS, True, weights=3)
    one.slave.enterInitializationMode()
    reference = [one.reference["weight.angle0"]]
    before = one.slave.getFloat64(reference, 3)
    text = one.refused(lambda: one.slave.setFloat64(reference, [0.1, math.nan, 0.2]))
    assert "weight[2].angle0 = nan rad: must be a finite number" in text
    assert one.slave.getFloat64(reference, 3) == before
    rotor = host(ROTOR, True, planes=2)
    reference = [rotor.reference["speed"], rotor.reference["plane.added_mass"]]
    text = rotor.refused(lambda: rotor.slave.setFloat64(reference, [9.0, 0.0, -1.0]))
    assert "plane[2].added_mass = -1.0 kg: must be a finite number, at least 0 kg" in text
    assert rotor.get(["speed"]) == {"speed": 300.0}
    one.slave.fmi3FreeInstance(one.slave.component)


@pytest.mark.parametrize("count", [0, 1, 3, 5])
def test_as_many_values_as_elements_are_demanded(host, count):
    rows = host(BALLS, True, weights=3)
    reference = [rows.reference["weight.angle"], rows.reference["F_xi"]]
    text = rows.refused(lambda: rows.slave.getFloat64(reference, count))
    assert f"as many values as value references have elements, 4, not {count}" in text
    knowns = [rows.reference["a_xi"], rows.reference["speed"]]
    for seed, changes in (([1.0, 2.0], count), ([1.0, 2.0, 3.0], 4)):
        text = rows.refused(
            lambda s=seed, n=changes: rows.slave.getDirectionalDerivative(reference, knowns, s, n)
        )
        assert "as many values as value references have elements" in text


def test_an_element_by_itself_is_refused_by_name(host):
    rows = host(ROTOR, True, planes=2)
    second = rows.reference["plane.F_xi"] + 2
    text = rows.refused(lambda: rows.slave.setFloat64([second], [1.0]))
    assert "plane[2].F_xi: is read and set with its array" in text


def test_arrays_are_of_fmi_3_alone(tmp_path):
    for options in ({}, {"backend": "python"}):
        with pytest.raises(ValueError, match=r"arrays = True: only FMI 3.0 has them"):
            build(BALLS, tmp_path, arrays=True, **options)
    assert list(tmp_path.iterdir()) == []


# --- in a tool ----------------------------------------------------------------------------------


@shapes
def test_fmpy_finds_nothing_wrong_with_arrays(unit, options, tmp_path):
    path = str(build(unit, tmp_path, fmi=3, arrays=True, **options))
    assert validate_fmu(path) == []
    description = fmpy.read_model_description(path)
    scalars = fmpy.read_model_description(str(build(unit, tmp_path, fmi=3, **options)))
    starts = [v.start for v in scalars.modelVariables if v.start is not None]
    found = [v.start for v in description.modelVariables if v.start is not None]
    assert sorted(" ".join(found).split()) == sorted(starts)
    sizes = {v.name: v.shape for v in description.modelVariables if v.shape}
    assert sum(map(math.prod, sizes.values())) + len(description.modelVariables) - len(
        sizes
    ) == len(scalars.modelVariables)


@pytest.mark.parametrize(
    ("unit", "options", "name", "values"),
    [
        (BALLS, {"weights": 3}, "weight[{}].angle0", [0.2, 1.9, 4.0]),
        (ROTOR, {"planes": 2}, "plane[{}].F_xi", [5.0, -2.0]),
    ],
)
def test_fmpy_simulates_arrays_as_scalars(unit, options, name, values, tmp_path):
    names = [name.format(k) for k in range(1, 1 + len(values))]
    plain = fmpy.simulate_fmu(
        str(build(unit, tmp_path / "scalars", fmi=3, **options)),
        stop_time=0.05,
        output_interval=0.0005,
        start_values=dict(zip(names, values, strict=True)),
    )
    rows = fmpy.simulate_fmu(
        str(build(unit, tmp_path / "arrays", fmi=3, arrays=True, **options)),
        stop_time=0.05,
        output_interval=0.0005,
        start_values={name.replace("[{}]", ""): " ".join(map(repr, values))},
    )
    for column in rows.dtype.names:
        found = np.atleast_2d(rows[column].T)
        parts = sorted(n for n in plain.dtype.names if re.sub(r"\[\d+\]", "", n) == column)
        parts = [column] if column in plain.dtype.names else parts
        assert found.tobytes() == np.array([plain[part] for part in parts]).tobytes(), column
    assert {re.sub(r"\[\d+\]", "", n) for n in plain.dtype.names} == set(rows.dtype.names)


def test_what_there_is_one_of_is_no_array():
    description = contents(ROTOR, fmi=3, arrays=True)["modelDescription.xml"].decode()
    assert 'name="plane[1].F_xi"' in description
    assert "Dimension" not in description
