"""Every example in a docstring works, and no array of a record that one makes can be written to."""

from __future__ import annotations

import doctest
import importlib
import linecache
import pkgutil
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from shared import Shared, replace_everywhere

import easeoff
from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, MeshCycle
from easeoff.contact.compliance.elastic_model import ElasticTeeth
from easeoff.contact.compliance.spread_deflection import SpreadDeflection
from easeoff.contact.compliance.weber_line_contact import WeberLineContact
from easeoff.contact.evaluation.marking_print import UnloadedPattern
from easeoff.contact.evaluation.tooth_passage import CarryingError
from easeoff.contact.lines.flank_splines import MonotoneCubic
from easeoff.contact.lines.mesh_lines import LoadedPlaces, tooth_ends
from easeoff.contact.mesh_wrench import MeshWrenches, SupportModes
from easeoff.contact.modification.modified_contact import ModifiedContact
from easeoff.contact.segments import HeldMembers
from easeoff.contact.supports.shaft import Bearing, Shaft, ShaftSection, ShaftSupport, StiffnessCurve
from easeoff.geometry import pair_geometry
from easeoff.study.case_in_mesh import CaseInMesh

MODULES = ["easeoff", *(found.name for found in pkgutil.walk_packages(easeoff.__path__, "easeoff."))]
#: Those whose examples take more than a second: they design, search, verify, or start other programs.
SLOW = (
    "easeoff.study.compare.comparison",
    "easeoff.study.design.case_design",
    "easeoff.study.design.optimization.setting_optimization",
    "easeoff.verification.case_verification",
)
#: Functions that many examples begin with and whose result depends on nothing but their arguments.
BEGINNINGS = (
    "cases.conversion.gear_pair",
    "study.analysis.case_analysis.analyze",
    "study.analysis.contact_analysis.contact_analysis",
    "study.design.optimal_modification.modify",
    "study.case_correction.correct_case",
    "study.wear_simulation.wear",
    "study.load_case_analysis.analyze_load_cases",
    "study.sweep.parameter_sweep.sweep",
    "study.vh.vh_check",
    "verification.flank_response.flank_response",
    "verification.correction_loop.correction_loop",
)


@pytest.fixture(scope="module", autouse=True)
def shared() -> Iterator[None]:
    """Many examples begin alike: that is computed once, wherever it is called."""
    modules = [importlib.import_module(name) for name in MODULES]
    once = Shared().once
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CaseInMesh, "of", classmethod(once(CaseInMesh.of.__func__)))  # type: ignore[attr-defined]
        patch.setattr(CaseInMesh, "misaligned", once(CaseInMesh.misaligned))
        for path in BEGINNINGS:
            place, _, name = path.rpartition(".")
            compute = getattr(importlib.import_module(f"easeoff.{place}"), name)
            for module in modules:
                if name in getattr(module, "__all__", ()):
                    getattr(module, name)  # imported on first use
            replace_everywhere(patch, compute, once(compute))
        yield


def tried_in(module: str) -> int:
    """Number of examples in a module, all of which work."""
    linecache.clearcache()  # before each docstring, doctest has a look at every file that is in it
    runner = doctest.DocTestRunner()
    for example in doctest.DocTestFinder().find(importlib.import_module(module)):
        runner.run(example, clear_globs=False)
        records = [value for value in example.globs.values() if is_record(value)]
        assert [place for record in records for place in writeable(record, example.name, set())] == []
        example.globs.clear()
    assert runner.failures == 0, module
    return runner.tries


def writeable(value: Any, place: str, seen: set[int]) -> Iterator[str]:
    """Places of arrays that can be written to, in a record and in what it holds."""
    entries: list[Any] = []
    if isinstance(value, np.ndarray) and not is_frozen(value):
        yield place
    elif isinstance(value, list | tuple | dict):
        entries = [(place, entry) for entry in (value.values() if isinstance(value, dict) else value)]
    elif is_record(value) and id(value) not in seen:
        seen.add(id(value))
        names = {*getattr(value, "__dict__", ()), *(field.name for field in fields(value))}
        entries = [(f"{place} {type(value).__name__}.{name}", getattr(value, name)) for name in sorted(names)]
    for within, entry in entries:
        yield from writeable(entry, within, seen)


def is_record(value: Any) -> bool:
    """Whether a value is a dataclass of the package."""
    return is_dataclass(value) and type(value).__module__.startswith("easeoff.")


def is_frozen(values: np.ndarray[Any, Any]) -> bool:
    """Whether neither an array nor what it is a view of can be written to."""
    return not values.flags.writeable and (values.base is None or is_frozen(values.base))


@pytest.mark.parametrize("folder", sorted({name.split(".")[1] for name in MODULES if "." in name} | {""}))
def test_examples_work(folder: str) -> None:
    found = [name for name in MODULES if name.split(".")[1:2] == [folder] * bool(folder) and name not in SLOW]
    assert sum(map(tried_in, found)) > 2


@pytest.mark.thorough
@pytest.mark.parametrize("module", SLOW)
def test_slow_examples_work(module: str) -> None:
    assert tried_in(module) > 2


def test_inner_records_of_the_contact_have_no_array_that_can_be_written_to() -> None:
    """Of records that no example of a public name makes."""
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    fields, middle = cycle.fields, np.full((2, 1), 0.5)
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    bearings = Bearing("head", 40.0, StiffnessCurve((1e3, 2e3), (0.004, 0.007)), 1e5), Bearing("tail", 100.0, 4e5)
    shaft = Shaft((ShaftSection(0.0, 120.0, 40.0),), bearings, reference=10.0)
    records = [
        error,
        ElasticTeeth(geometry.teeth, None, geometry.pair),
        HeldMembers([SupportModes(np.zeros((6, 6)), np.zeros(6))], MeshWrenches.of(geometry)),
        LoadedPlaces(fields, middle, middle),
        ModifiedContact(cycle, np.array([100.0]), ("bias",)),
        MonotoneCubic(np.arange(3.0), np.arange(3.0)),
        SpreadDeflection.of(fields, "gear", STEEL),
        ShaftSupport(shaft, (0.0, 20.0, 0.0), np.eye(3)),
        UnloadedPattern.of(cycle, 6.0),
        WeberLineContact(np.ones(2), np.full(2, 30.0), np.full(2, 3.0), np.full(2, 4.0), STEEL, STEEL),
        tooth_ends(fields, "gear", middle),
    ]
    assert all(map(is_record, records))
    assert [place for record in records for place in writeable(record, "", set())] == []
