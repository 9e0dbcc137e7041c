# Everything needed is set up on first use; only Python 3.11+ and pip are expected on the machine.
PYTHON ?= python3
READY := .venv/bin/easeoff
# The tests need more than a user does; the time stamp says that it is there.
READY_FOR_TESTS := .venv/tests

run: $(READY)
	$(READY) run fm-11x41 -o results/fm-11x41.nc --plots results
	$(READY) show results/fm-11x41.nc

test: $(READY_FOR_TESTS)
	.venv/bin/python -m pytest -q

$(READY): pyproject.toml
	test -d .venv || $(PYTHON) -m venv --without-pip .venv
	$(PYTHON) -m pip --python .venv install -q -e .
	touch $@

$(READY_FOR_TESTS): $(READY)
	$(PYTHON) -m pip --python .venv install -q -e '.[test]'
	touch $(READY) $@

.PHONY: run test
