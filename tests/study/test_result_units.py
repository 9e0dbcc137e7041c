"""Units of results as other programs read them."""

from __future__ import annotations

import pytest

from easeoff.core.attributes import variables

#: Units of entries that another variable names.
BY_ENTRY = {"um per setting_units", "1 per setting_units", "1 per limit_units"}
UNITS = sorted({row[0] for row in variables().values()} - BY_ENTRY)
pint = pytest.importorskip("pint")


def test_pint_reads_all_units_with_cf_xarray_and_not_without() -> None:
    with pytest.raises(TypeError):  # the page on conventions says so: then it need not
        pint.UnitRegistry().Unit("mm-1")
    units = pytest.importorskip("cf_xarray.units").units
    for text in UNITS:
        assert units.Unit(text) is not None
    assert units.Quantity(1.0, "N m urad-1").to("N m rad-1").magnitude == pytest.approx(1e6)
    assert units.Quantity(1.0, "mm3").to("m3").magnitude == pytest.approx(1e-9)
    for text in BY_ENTRY:
        with pytest.raises(pint.errors.UndefinedUnitError):
            units.Unit(text)
