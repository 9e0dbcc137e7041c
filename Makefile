# Everything needed is set up on first use; only Python 3.11+ and pip are expected on the machine.
PYTHON ?= python3
READY := .venv/bin/easeoff

run: $(READY)
	$(READY) run fm-11x41 -o results/fm-11x41.nc --plots results
	$(READY) show results/fm-11x41.nc

test: $(READY)
	.venv/bin/python -m pytest -q

$(READY): pyproject.toml
	$(PYTHON) -m venv --without-pip .venv
	$(PYTHON) -m pip --python .venv install -q -e '.[test]'
	touch $@

.PHONY: run test
