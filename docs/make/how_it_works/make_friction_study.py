"""Make the studies and the formula of ``friction/ehl``: python docs/make friction_study [FOLDER].

All 31,500 combinations of the dissertation's design and 3000 of the refined one, half an hour of one processor. Rows
are kept in FOLDER, here if none is named, so that an interrupted run goes on where it stopped; with the extra ``dask``
all processors share the work. Prints the tables of docs/how_it_works/notes/mixed_lubrication.md.
"""

from __future__ import annotations

import importlib.util
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import xarray as xr
from folders import DATA
from tabulate import tabulate
from tqdm import tqdm

from easeoff.core.output_file import whole_file
from easeoff.friction import friction_coefficient
from easeoff.friction.ehl.study import Design, fit_friction, run_study
from easeoff.friction.ehl.study.friction_formula import (
    FORMULA_FILE,
    REGIMES,
    lambda_ratio,
    logarithms_of,
    study_inputs,
    write_formula,
)
from easeoff.friction.ehl.study.study_design import REFINED

STUDIES = ((Design(), None), (REFINED, 3000))
# Space-filling subsets of the design of the dissertation and of ``REFINED``, run with the defaults.
STUDY_FILES = tuple(DATA / name for name in ("friction_study.nc", "friction_study_refined.nc"))
INPUTS = 7  # the first variables, which are exact
ROUNDED = {"dtype": "float32", "significant_digits": 5, "quantize_mode": "GranularBitRound"}


def make(folder: Path) -> None:
    """Run both studies and put them into ``docs/data``, rounded."""
    for (design, wanted), target in zip(STUDIES, STUDY_FILES, strict=True):
        with tqdm(desc=target.name, unit="case") as bar:
            dataset = run_study(
                folder / target.name,
                wanted,
                design=design,
                dask=importlib.util.find_spec("dask") is not None,
                progress=lambda done, _, bar=bar: bar.update(done - bar.n),  # type: ignore[misc]
            )
        dataset = dataset.drop_vars("run_time")
        packed = {"zlib": True, "complevel": 9, "shuffle": True}
        inputs = list(dataset.data_vars)[:INPUTS]
        encoding = {
            name: packed | (ROUNDED if variable.dtype.kind == "f" and name not in inputs else {})
            for name, variable in dataset.data_vars.items()
        }
        with whole_file(target) as temporary:
            dataset.to_netcdf(temporary, engine="netcdf4", encoding=encoding)


def spread(values: np.ndarray) -> str:
    """Median and the range of 5 to 95 %."""
    low, middle, high = np.percentile(values, [5.0, 50.0, 95.0])
    return f"{middle:.4f} ({low:.4f} to {high:.4f})"


def beside_the_dissertation(dataset: xr.Dataset) -> str:
    """Friction by regime beside equation 5.11."""
    inputs = study_inputs(dataset)
    ratio = np.exp(lambda_ratio(*logarithms_of(*inputs)))
    theirs = friction_coefficient(
        hertz_pressure=inputs[0],
        equivalent_radius=inputs[1],
        rolling_velocity=inputs[2],
        slide_to_roll=inputs[3],
        roughness=(1e-6 * dataset["roughness_1"].values, 1e-6 * dataset["roughness_2"].values),
        temperature=dataset["temperature"].values,
    )
    ours, share = dataset["friction_coefficient"].values, dataset["asperity_share"].values
    rows = []
    for low, high in pairwise(REGIMES):
        own = (ratio >= low) & (ratio < high)
        error = np.log(ours[own] / theirs[own])
        cells = [f"{100.0 * np.median(share[own]):.0f} %", spread(ours[own]), spread(theirs[own])]
        rows.append(
            [f"{low:g} to {high:g}", own.sum(), *cells, *(f"{np.exp(x):.2f}" for x in (error.mean(), error.std()))]
        )
    heads = ["Λ", "cases", "asperity share", "friction coefficient", "equation 5.11", "ours over 5.11", "scatter"]
    return tabulate(rows, heads, "github", disable_numparse=True)


def main() -> None:
    """Make everything and print the tables."""
    make(Path(sys.argv[1]) if sys.argv[1:] else Path())
    studies = [xr.load_dataset(path, engine="netcdf4") for path in STUDY_FILES]
    formula = fit_friction(*studies)
    write_formula(FORMULA_FILE, formula)
    print(beside_the_dissertation(studies[0]))
    rows = [[f"{r.lowest:g} to {r.highest:g}", r.cases, f"{r.rms:.3f}", f"{r.worst:.2f}"] for r in formula.regimes]
    print(tabulate(rows, ["Λ", "cases", "rms error of ln μ", "worst"], "github", disable_numparse=True))
    print(f"all: {formula.prediction_error:.3f}, worst {formula.worst_error:.2f}")


if __name__ == "__main__":
    main()
