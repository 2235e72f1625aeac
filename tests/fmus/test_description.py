"""The model descriptions: valid for a demanding tool, and true."""

from __future__ import annotations

import itertools
import math
import re
from functools import cache
from xml.etree import ElementTree

import fmpy
import pytest

from autobalancer.fmus.build import contents
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.xml import fmi2, fmi3
from autobalancer.fmus.xml.description import Capabilities, options_in
from autobalancer.fmus.xml.types import SI_UNITS
from tests.fmus.conftest import SHAPES


@pytest.fixture(params=SHAPES, ids=lambda s: "-".join([s[0], *map(str, s[1].values())]))
def shape(request):
    return request.param


@cache
def described(unit, **options):
    return ElementTree.fromstring(contents(unit, **options)["modelDescription.xml"])


@pytest.fixture
def description(unit, options):
    return described(unit, **options)


def variables_of(description):
    return description.findall("ModelVariables/ScalarVariable")


def test_date_ends_in_z(description):
    assert re.fullmatch(
        r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", description.get("generationDateAndTime")
    )


def test_causality_variability_initial_and_start_are_a_legal_combination(description):
    """FMI 2.0.4, tables of section 2.2.7, and where `start` must or must not stand."""
    legal = {
        ("parameter", "fixed", "exact", True),
        ("parameter", "tunable", "exact", True),
        ("input", "continuous", None, True),
        ("output", "continuous", "calculated", False),
    }
    for variable in variables_of(description):
        (kind,) = variable
        found = (
            variable.get("causality"),
            variable.get("variability"),
            variable.get("initial"),
            kind.get("start") is not None,
        )
        assert found in legal, variable.get("name")
        if kind.tag == "Boolean":
            assert found[1] == "fixed"
            assert kind.get("start") in ("true", "false")


def test_value_references_and_names_are_unique(description):
    seen = [(v[0].tag, v.get("valueReference")) for v in variables_of(description)]
    assert len(set(seen)) == len(seen)
    names = [v.get("name") for v in variables_of(description)]
    assert len(set(names)) == len(names)
    identifier = r"[A-Za-z_][A-Za-z0-9_]*(\[[1-9][0-9]*(,[1-9][0-9]*)?\])?"
    structured = rf"{identifier}(\.{identifier})*"
    for name in names:
        assert re.fullmatch(rf"{structured}|der\({structured}(,[1-9])?\)", name)


def test_every_unit_of_measure_is_defined(description):
    defined = [u.get("name") for u in description.findall("UnitDefinitions/Unit")]
    assert len(set(defined)) == len(defined)
    used = {v[0].get("unit") for v in variables_of(description) if v[0].tag == "Real"}
    assert used == set(defined)


def test_base_unit_exponents_agree_with_the_units_names():
    base = {
        "1": {},
        "kg": {"kg": 1},
        "m": {"m": 1},
        "s": {"s": 1},
        "rad": {"rad": 1},
        "N": {"kg": 1, "m": 1, "s": -2},
        "W": {"kg": 1, "m": 2, "s": -3},
    }

    def factor(text):
        match = re.fullmatch(r"([A-Za-z]+|1)(\d?)", text)
        assert match, text
        name, power = match.groups()
        return {k: v * int(power or 1) for k, v in base[name].items()}

    for unit, exponents in SI_UNITS.items():
        total: dict[str, int] = {}
        for sign, part in itertools.zip_longest((1, -1), unit.split("/"), fillvalue=""):
            for word in filter(None, part.split(".")):
                for key, power in factor(word).items():
                    total[key] = total.get(key, 0) + sign * power
        assert {k: v for k, v in total.items() if v} == exponents, unit


def test_structure_lists_every_output_with_legal_dependencies(description):
    variables = variables_of(description)
    outputs = [str(i) for i, v in enumerate(variables, 1) if v.get("causality") == "output"]
    for element, known, kinds in (
        ("Outputs", {"input"}, {"dependent", "fixed"}),
        ("InitialUnknowns", {"input", "parameter"}, {"dependent"}),
    ):
        unknowns = description.findall(f"ModelStructure/{element}/Unknown")
        assert [u.get("index") for u in unknowns] == outputs
        for unknown in unknowns:
            indices = [int(i) for i in unknown.get("dependencies").split()]
            assert indices == sorted(set(indices))
            assert {variables[i - 1].get("causality") for i in indices} <= known
            found = unknown.get("dependenciesKind").split()
            assert len(found) == len(indices)
            assert set(found) <= kinds


def test_derivative_attribute_points_at_the_derived_variable(description):
    variables = variables_of(description)
    marked = set()
    for variable in variables:
        index = variable[0].get("derivative")
        if index is None:
            continue
        derived, name = variables[int(index) - 1], variable.get("name")
        of = derived.get("name")
        slope = re.sub(r"(^|\.)([xy])$", r"\1v\2", of)
        higher = re.sub(r"^der\(([^(),]+)(?:,(\d))?\)$", _next_order, of)
        assert name in (f"der({of})", slope, higher, of.replace(".angle", ".speed"))
        assert derived.get("causality") == variable.get("causality")
        marked.add(variable.get("causality"))
    assert marked == {"input"}  # OMSimulator takes a marked output for a state's derivative


def _next_order(match):
    return f"der({match[1]},{int(match[2] or 1) + 1})"


def test_types_say_quantity_display_unit_and_nominal(description):
    types = {t.get("name"): t[0] for t in description.findall("TypeDefinitions/SimpleType")}
    units = {u.get("name"): u for u in description.findall("UnitDefinitions/Unit")}
    used = set()
    for variable in variables_of(description):
        if variable[0].tag == "Real":
            used.add(variable[0].get("declaredType"))
            declared = types[variable[0].get("declaredType")]
            assert declared.get("unit") == variable[0].get("unit")
            assert declared.get("quantity")
            assert float(declared.get("nominal")) > 0.0
    assert used == set(types)
    shown = {"rad/s": ("rpm", 1.0 / (2.0 * math.pi / 60.0)), "rad": ("deg", 180.0 / math.pi),
             "m": ("mm", 1000.0)}  # fmt: skip
    for declared in types.values():
        display = shown.get(declared.get("unit"))
        assert declared.get("displayUnit") == (display and display[0])
        if display:
            (element,) = units[declared.get("unit")].findall("DisplayUnit")
            assert element.get("name") == display[0]
            assert float(element.get("factor")) == pytest.approx(display[1], rel=1e-15)


def test_bounds_are_values_that_the_unit_takes(unit, options, description, native_probe):
    """`min` and `max` are allowed, what lies beyond is not; an excluded bound is in the words."""
    for variable in variables_of(description):
        if variable[0].tag == "Boolean":
            continue
        declared = CATALOGUE[unit].sized(options).layout
        declared = declared.reals[declared.index[variable.get("name")]]
        low = variable[0].get("min")
        if declared.above:
            assert low is None
            assert f"(above {declared.minimum:g}" in variable.get("description")
            assert declared.problem(declared.minimum)
        elif low is not None:
            assert not declared.problem(float(low))
            assert declared.problem(math.nextafter(float(low), -math.inf))
        high = variable[0].get("max")
        if high is not None:
            for value, allowed in ((float(high), True), (math.nextafter(float(high), 9.9), False)):
                instance = native_probe(unit, **options)
                instance.put(variable.get("name"), value)
                if allowed:
                    instance.exit_initialization_mode()
                else:
                    with pytest.raises(RuntimeError, match=variable.get("name")):
                        instance.exit_initialization_mode()


def test_fmi_3_description_is_valid_and_says_the_same(unit, options, description, tmp_path):
    """Read and checked by fmpy against the standard's schema; only the references of Booleans
    differ, which FMI 3.0 wants unique over all types."""
    sized = CATALOGUE[unit].sized(options)
    can = Capabilities(time_derivatives=True, directional_derivatives=True)
    text = fmi3.model_description(sized, unit, "token", "1.0", can)
    (tmp_path / "modelDescription.xml").write_bytes(text)
    found = fmpy.read_model_description(str(tmp_path))
    assert found.fmiVersion == "3.0"
    assert found.instantiationToken == "token"
    element = ElementTree.fromstring(text).find("CoSimulation")
    assert element.get("providesDirectionalDerivatives") == "true"
    references = {v.name: v.valueReference for v in found.modelVariables}
    assert sorted(references.values()) == list(range(len(references)))
    assert references == fmi3.value_references(sized.layout)
    reals, booleans = len(sized.layout.reals), len(sized.layout.booleans)
    assert references.pop("time") == reals + booleans
    by_name = {v.name: v for v in found.modelVariables}
    assert by_name["time"].causality == "independent"
    outputs = {u.variable.name: {d.name for d in u.dependencies} for u in found.outputs}
    variables = variables_of(description)
    for old in variables:
        new = by_name[old.get("name")]
        shift = reals if old[0].tag == "Boolean" else 0
        assert new.valueReference == int(old.get("valueReference")) + shift
        assert (new.causality, new.variability) == (old.get("causality"), old.get("variability"))
        start = old[0].get("start")
        assert new.start == start
        assert (new.min, new.max, new.unit) == tuple(map(old[0].get, ("min", "max", "unit")))
        index = old[0].get("derivative")
        of = index and variables[int(index) - 1].get("name")
        if new.causality != "output":  # FMI 2.0 has it of inputs alone, for OMSimulator's sake
            assert (new.derivative and new.derivative.name) == of
    for unknown in description.findall("ModelStructure/Outputs/Unknown"):
        names = {variables[int(i) - 1].get("name") for i in unknown.get("dependencies").split()}
        assert outputs[variables[int(unknown.get("index")) - 1].get("name")] == names
    assert options_in(ElementTree.fromstring(text)) == {"unit": unit, **sized.options}


def test_capabilities_and_sources_stand_in_the_description():
    sized = CATALOGUE["LiquidBalancer"].sized()
    can = Capabilities(True, True, True, True, ("liquid.c", "unit.c"))
    two = ElementTree.fromstring(fmi2.model_description(sized, "Liquid", "token", "1", can))
    element = two.find("CoSimulation")
    assert element.get("canInterpolateInputs") == "true"
    assert element.get("maxOutputDerivativeOrder") == "1"
    assert element.get("providesDirectionalDerivative") == "true"
    assert [file.get("name") for file in element.iter("File")] == ["liquid.c", "unit.c"]


@pytest.mark.slow
def test_declared_dependencies_are_the_real_ones(unit, options, native_probe):
    """Change each input and parameter in turn and see which outputs answer."""
    layout = CATALOGUE[unit].sized(options).layout
    known = [v for v in layout.reals if v.causality != "output"]
    outputs = [v for v in layout.reals if v.causality == "output"]
    every = list(range(len(layout.reals)))
    answered: dict[str, set[str]] = {v.name: set() for v in outputs}

    placed = _station if options.get("kind") == "flexible" else lambda name: False
    for as_force in (False, True):
        instance = native_probe(unit, **options)
        # nowhere a zero that could hide a dependency
        for k, variable in enumerate(known):
            (value,) = instance.look(variable.name)
            if not any(f(variable.name) for f in (placed, lambda name: "radius" in name)):
                # of the speed's third derivative more, to be seen beside the speed's fourth power
                own = value or (0.3 if variable.name != "der(acceleration,2)" else 3e6)
                instance.put(variable.name, own * (1.0 + 0.03 * (k + 1) / len(known)))
        if "inertia_as_force" in layout.boolean_index:
            instance.put("inertia_as_force", as_force)
        base = instance.get_real(every)
        rounding = {
            v.unit: 1e-14
            * max(abs(base[layout.index[o.name]]) for o in outputs if o.unit == v.unit)
            for v in outputs
        }
        for variable in known:
            (value,) = instance.look(variable.name)
            if placed(variable.name):
                continue
            instance.put(variable.name, value * 1.1)
            values = instance.get_real(every)
            instance.put(variable.name, value)
            for out in outputs:
                change = abs(values[layout.index[out.name]] - base[layout.index[out.name]])
                if change > rounding[out.unit]:
                    answered[out.name].add(variable.name)
    for out in outputs:
        declared = {*out.depends, *out.begins} - {v.name for v in layout.booleans}
        assert answered[out.name] <= declared, (out.name, answered[out.name] - declared)
        # a direct dependency that is not there would look like an algebraic loop
        beyond = set(out.depends) - answered[out.name]
        if options.get("kind") == "flexible" and out.name.startswith("der(plane"):
            # only on a support does damping, unlike along x and y, turn a force to the other axis
            beyond = {name for name in beyond if not re.match(r"plane\[\d+\]\.F_", name)}
        assert not beyond, (out.name, beyond)


def _station(name):
    """Whether a parameter must be the place of a station."""
    return re.fullmatch(r"(station\[\d+\]\.z|(support|plane|unbalance)\[\d+\]\.position)", name)
