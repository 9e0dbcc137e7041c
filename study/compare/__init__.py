"""Comparison of solvers on contact problems: run, table, report."""
