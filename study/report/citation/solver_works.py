"""Published works of the solvers, by the names of the table of solvers."""

from __future__ import annotations

from collections.abc import Mapping

from .published_work import PublishedWork


def _article(key: str, author: str, title: str, year: str, doi: str) -> PublishedWork:
    return PublishedWork(key, "misc", {"author": author, "title": title, "year": year, "doi": doi})


#: Works with a DOI as in the bibliography; solvers that are not here have none there.
SOLVER_WORKS: Mapping[str, tuple[PublishedWork, ...]] = {
    "clarabel": (
        _article("goulart_2024", "P. J. Goulart and Y. Chen", "Clarabel", "2024", "10.48550/arXiv.2405.12762"),
    ),
    "cvxpy": (_article("agrawal_2019", "A. Agrawal and others", "CVXPY", "2019", "10.48550/arXiv.1910.12430"),),
    "daqp": (_article("arnstroem_2022", "D. Arnström and others", "DAQP", "2022", "10.1109/TAC.2022.3176430"),),
    "ecos": (_article("domahidi_2013", "A. Domahidi and others", "ECOS", "2013", "10.23919/ECC.2013.6669541"),),
    "highs": (_article("huangfu_2018", "Q. Huangfu and J. A. J. Hall", "HiGHS", "2018", "10.1007/s12532-017-0130-5"),),
    "lemke": (
        _article(
            "lemke_1965",
            "C. E. Lemke",
            "Bimatrix equilibrium points and mathematical programming",
            "1965",
            "10.1287/mnsc.11.7.681",
        ),
    ),
    "osqp": (_article("stellato_2020", "B. Stellato and others", "OSQP", "2020", "10.1007/s12532-020-00179-2"),),
    "piqp": (_article("schwan_2023", "R. Schwan and others", "PIQP", "2023", "10.1109/CDC49753.2023.10383915"),),
    "proxqp": (_article("bambade_2022", "A. Bambade and others", "ProxQP", "2022", "10.15607/RSS.2022.XVIII.040"),),
    "qpalm": (_article("hermans_2022", "B. Hermans and others", "QPALM", "2022", "10.1007/s12532-022-00218-0"),),
    "quadprog": (
        _article(
            "goldfarb_1983",
            "D. Goldfarb and A. Idnani",
            "A numerically stable dual method for solving strictly convex quadratic programs",
            "1983",
            "10.1007/BF02591962",
        ),
    ),
    "scs": (_article("odonoghue_2021", "B. O'Donoghue", "SCS", "2021", "10.1137/20M1366307"),),
}
