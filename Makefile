# Everything needed is set up on first use; only Python 3.11+, its headers and pip are expected on the machine.
PYTHON ?= python3
WORKERS ?= 2
export PYTHON
PIP := $(PYTHON) -m pip --python .venv install -q
PYTEST := .venv/bin/python -m pytest -q -n $(WORKERS) --dist loadscope
# The tests need more than a user does, the checks more than the tests; the time stamps say that it is there.
READY := .venv/bin/easeoff
READY_FOR_TESTS := .venv/tests
READY_FOR_CHECKS := .venv/checks
READY_FOR_DOCS := .venv/docs
SITE := docs/_build/html
# What is compiled when the package is installed.
TYPES := $(wildcard contact/*/*.pxd contact/*/*/*.pxd)
KERNELS := builder/compiled_backend.py $(TYPES) $(TYPES:.pxd=.py)

run: $(READY)
	$(READY) run fm-11x41 -o results/fm-11x41.nc --plots results
	$(READY) show results/fm-11x41.nc
	$(READY) report results/fm-11x41.nc -o results/fm-11x41.html

# What is quick and touches every module. Examples that are drawn at random are drawn alike each time.
test: $(READY_FOR_TESTS)
	$(PYTEST) -m "not thorough"

# What the quick tests leave out.
thorough: CHOSEN := thorough
thorough: $(READY_FOR_CHECKS)
	$(PYTEST) -m "$(CHOSEN)"

# Style, spelling, types.
lint: $(READY_FOR_CHECKS)
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/codespell
	.ci/types

# Everything: style, spelling, types, the site, all tests, and the quick ones again as below.
check: lint docs
	$(PYTEST)
	$(MAKE) lowest

# The quick tests on the package as it is installed from a wheel that is built from the source distribution: with the
# lowest versions that pyproject.toml allows, or with the newest; PYTHON=python3.13 takes another Python. uv finds the
# lowest: the first from each bound on that has a wheel for that Python; what they require in turn is the newest. Where
# an old version fails, raise its bound.
lowest newest: $(READY_FOR_CHECKS)
	.ci/installed $@ $(WORKERS)

# What is published: source distribution and wheel, from the files of the repository alone.
dist: $(READY_FOR_CHECKS)
	rm -rf dist
	place=$$(mktemp -d) && git ls-files -z | xargs -0 cp --parents -t $$place \
	&& .venv/bin/uv build --python $(PYTHON) -o dist $$place; status=$$?; rm -rf $$place; exit $$status

# The site, from pages, docstrings and examples that are run; a warning ends it. No network is needed, here and to read.
docs: $(READY_FOR_DOCS)
	.venv/bin/python -m sphinx -b html -j 2 -q -W --keep-going -d docs/_build/doctrees docs $(SITE)
	@echo "wrote $(SITE)/index.html"

# Other examples than those of the tests, and more of them.
random: SEED := $(or $(SEED),$(shell $(PYTHON) -c "import secrets; print(secrets.randbits(32))"))
random: $(READY_FOR_TESTS)
	@echo "seed $(SEED): 'make random SEED=$(SEED)' draws the same again"
	$(PYTEST) -m "hypothesis or random" --hypothesis-profile random --hypothesis-seed $(SEED)

# Mutated inputs, kills, full disks, concurrent runs, disturbed analyses: nothing may break the command line, and no claim
# about a contact problem be false.
fuzz: SEED := $(or $(SEED),$(shell $(PYTHON) -c "import secrets; print(secrets.randbits(32))"))
fuzz: COUNT := $(or $(COUNT),500)
fuzz: $(READY_FOR_TESTS)
	@echo "seed $(SEED): 'make fuzz SEED=$(SEED)' draws the same again"
	.venv/bin/python fuzz/fuzz.py --seed $(SEED) --count $(COUNT)

.venv:
	$(PYTHON) -m venv --without-pip .venv
	$(PIP) pip

$(READY): pyproject.toml $(KERNELS) | .venv
	$(PIP) -e .
	touch $@

$(READY_FOR_TESTS): pyproject.toml $(KERNELS) | .venv
	$(PIP) -e '.[test]'
	touch $(READY) $@

$(READY_FOR_CHECKS): pyproject.toml $(KERNELS) | .venv
	$(PIP) -e '.[test,lint,dask]'
	touch $(READY) $(READY_FOR_TESTS) $@

$(READY_FOR_DOCS): pyproject.toml $(KERNELS) | .venv
	$(PIP) -e '.[docs]'
	touch $(READY) $@

.PHONY: run test thorough lint check docs lowest newest dist random fuzz
