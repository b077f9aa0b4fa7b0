# Every target does the set-up it needs; what is already there is left alone, so a second call is quick and offline.
#   make PYTHON=/path/to/python3.12 ...    another interpreter for the environment
#   make render SCENE=scenes/... OUT=...   another picture

VENV := .venv
SCENE ?= scenes/h3/seifert-weber.yaml
OUT ?= out/$(basename $(notdir $(SCENE))).png
export PYTHON

.PHONY: help setup render test check format bench accuracy builds clean

help:
	@echo 'make render   set up, render $(SCENE) and name the picture'
	@echo 'make test     set up, check the code, run the tests'
	@echo 'make check    ruff (rules, format) and mypy'
	@echo 'make format   let ruff rewrite the code'
	@echo 'make bench    measure on this computer'
	@echo 'make accuracy  measure again what accuracy targets choose from (a quarter of an hour)'
	@echo 'make builds   measure how long the programs of all library scenes take to build'
	@echo 'make setup    only the environment $(VENV) and an OpenCL device that works'
	@echo 'make clean    remove what was built, and $(VENV)'

# The stamp is renewed when the list of dependencies changes.
$(VENV)/.installed: setup.cfg pyproject.toml
	@tools/ensure_venv.sh $(VENV)
	@echo 'set-up: pip install -e .[test]'
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check -e '.[test]'
	@touch $@

# Asked at every call, in a third of a second: a driver may have come, gone or been replaced.
setup: $(VENV)/.installed
	@tools/ensure_opencl.sh $(VENV)

render: setup
	@mkdir -p $(dir $(OUT))
	@$(VENV)/bin/thurston render $(SCENE) -o $(OUT) --force
	@echo 'Picture: $(abspath $(OUT))'

test: setup check
	$(VENV)/bin/pytest -n auto --dist loadfile

check: $(VENV)/.installed
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy

format: $(VENV)/.installed
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .

bench: setup
	$(VENV)/bin/python benchmarks/bench.py

accuracy: setup
	$(VENV)/bin/python benchmarks/measure_accuracy.py

builds: setup
	$(VENV)/bin/python benchmarks/builds.py

clean:
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
