# All commands work in the virtual environment $(VENV), which the first one makes with $(PYTHON).
# Another Python beside it: make check PYTHON=python3.13 VENV=.venv-3.13

.DEFAULT_GOAL := help
.NOTPARALLEL:

PYTHON ?= python3
VENV ?= .venv
DIST ?= dist
BIN := $(VENV)/bin
# beside it may be those of a release, for other machines
NEWEST_WHEEL = $$(ls -t "$(DIST)"/sevenbar-*.whl | head -1)
# a stale Cargo.lock is mended on a desk and refused in CI
LOCKED := $(if $(CI),--locked)
# wheels as small as they get
PACKED := --compression-level 9
# by another name, since a line with $(MAKE) itself is run by make -n, too
AGAIN_MAKE = $(MAKE) --no-print-directory
# on all cores
PYTEST = $(BIN)/pytest -n auto --dist worksteal
# and one more process, since tests in a browser wait more than they work
PROCESSES = $$(($$(getconf _NPROCESSORS_ONLN) + 1))
# with the folders, so that a file taken away counts as a change
RUST := Cargo.toml Cargo.lock $(shell find crates)
# a build is due, too, where somebody removed the compiled core
LOST := $(if $(wildcard python/sevenbar/_core*.so),,lost-core)

# maturin takes these before its own folder
export VIRTUAL_ENV := $(abspath $(VENV))
unexport CONDA_PREFIX
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_QUIET := 1

.PHONY: help
help:  ## This list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-9s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))

.PHONY: demo
demo: $(VENV)/.installed  ## Analyse the two papers' linkages; tables and figures into demo/
	$(BIN)/sevenbar analyze rssr --out demo --force
	$(BIN)/sevenbar analyze seven_r --out demo/seven_r --force

# lints of one process each beside tests on all cores
.PHONY: check
check: $(VENV)/.installed-dev  ## The lints and the fast tests, for every change
	@$(AGAIN_MAKE) lint rust-test >$(VENV)/lints.txt 2>&1 & lints=$$!; \
	  $(PYTEST) -m "not slow and not proof"; tests=$$?; \
	  wait $$lints; lints=$$?; cat $(VENV)/lints.txt; [ $$tests = 0 ] && [ $$lints = 0 ]

.PHONY: test
test: $(VENV)/.installed-dev have-chromium rust-test  ## Every test but the proofs of an hour
	$(PYTEST) -n $(PROCESSES)

.PHONY: proof
proof: $(VENV)/.installed-dev  ## The longest: ten thousand random loops against a search, and the like
	$(PYTEST) -m proof

# import-linter without its cache, which has passed for a module that was gone
.PHONY: lint
lint: $(VENV)/.installed-dev $(VENV)/.stub-checked  ## Formatting, lints, types, the stub of the core, layers
	@cargo fmt --version >/dev/null 2>&1 && cargo clippy --version >/dev/null 2>&1 || \
	  { echo "rustfmt or clippy is missing; add them: rustup component add rustfmt clippy" >&2; exit 1; }
	cargo fmt --check
	cargo clippy $(LOCKED) --quiet --workspace --all-targets -- -D warnings
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo --no-cache

.PHONY: rust-test
rust-test: have-cargo
	cargo test $(LOCKED) --quiet --workspace --profile quick

.PHONY: format
format: $(VENV)/.installed-dev  ## Write the formatting and the safe repairs into the sources
	cargo fmt
	$(BIN)/ruff check --fix-only
	$(BIN)/ruff format

.PHONY: wheel
wheel: $(VENV)/.maturin  ## Build dist/*.whl
	$(BIN)/maturin build --release $(LOCKED) $(PACKED) --out "$(DIST)"

# zig links against an old glibc and for other processors; twice the same core, since it is one abi3 wheel for all Pythons
.PHONY: release
release: $(VENV)/.maturin  ## Into dist/: wheels for Linux (x86_64, aarch64; glibc 2.17 on) and the source, checked
	$(BIN)/pip install "ziglang>=0.13" "twine>=6" "abi3audit>=0.0.20"
	rm -rf "$(DIST)"
	for processor in x86_64 aarch64; do \
	  rustup target add $$processor-unknown-linux-gnu 2>/dev/null && \
	  PATH="$(abspath $(BIN)):$$PATH" $(BIN)/maturin build --release --locked --zig --compatibility manylinux2014 \
	    --target $$processor-unknown-linux-gnu $(PACKED) --out "$(DIST)" || exit 1; \
	done
	$(BIN)/maturin sdist --out "$(DIST)"
	$(BIN)/twine check --strict "$(DIST)"/*
	$(BIN)/abi3audit --strict "$(DIST)"/*.whl
	@ls -l "$(DIST)"

# build123d (extra cad) has asked for NumPy 2 since its first version that serves, so it is left out; so is the site
.PHONY: oldest
oldest: wheel  ## The fast tests with the oldest versions of all dependencies that pyproject.toml allows
	rm -rf "$(VENV)-oldest"
	$(PYTHON) -m venv "$(VENV)-oldest"
	$(BIN)/python tests/oldest_versions.py >"$(VENV)-oldest/versions.txt"
	$(VENV)-oldest/bin/pip install -r "$(VENV)-oldest/versions.txt" "$(NEWEST_WHEEL)" \
	  hypothesis mpmath nbformat playwright pytest pytest-xdist yourdfpy
	$(VENV)-oldest/bin/pytest -n auto --dist worksteal -m "not slow and not proof" -o filterwarnings= \
	  $(foreach name,docs/test_docs_reference docs/test_docs_site export/test_export_solids project/test_layers description/test_step_axes,--ignore tests/$(name).py)

# the wheel in an environment of its own, so that no peer changes the one for work and sizes are an installation's;
# a quick look: make bench BENCH=--quick
.PHONY: bench
bench: wheel  ## Sevenbar beside its peers, installed one by one: docs/benchmarks.md
	$(PYTHON) -m venv --clear build/bench
	build/bench/bin/pip install "$(NEWEST_WHEEL)[studio]"
	build/bench/bin/python -m evidence.benches --install $(BENCH)

.PHONY: accuracy
accuracy: $(VENV)/.installed-dev  ## Measure how exact every loop of the gallery is; writes docs/accuracy.md
	$(BIN)/python -m evidence.accuracy

.PHONY: structure
structure: $(VENV)/.installed-dev  ## Count lines, and the rooms, floors, arrows and circles of what imports what
	$(BIN)/python -m evidence.structure

.PHONY: tutorial
tutorial: $(VENV)/.installed-dev  ## Write the tutorial's outputs and pictures anew
	$(BIN)/python tests/tutorial_pages.py

.PHONY: pages
pages: $(VENV)/.installed-dev  ## Write the tables of keys, commands, modules and the gallery into the pages
	$(BIN)/python docs/_extensions/written_parts.py

.PHONY: slow-tests
slow-tests: $(VENV)/.installed-dev have-chromium  ## Run every test and write anew which are slow, after many were added
	$(PYTEST) --write-slow-tests

.PHONY: golden
golden: $(VENV)/.installed-dev  ## Write anew what commands and figures say of the gallery, after a change that is meant
	$(BIN)/python tests/golden.py

.PHONY: docs
docs: $(VENV)/.installed-docs  ## The documentation site, into build/site; a warning fails it
	$(BIN)/python -m sphinx --builder html --fail-on-warning --keep-going --quiet --doctree-dir build/site-pages docs build/site
	@echo "open build/site/index.html"

LINKAGES ?= 1000000
FILES ?= 10000000
THREADS ?= 2
SEED ?= 1
# ways to do anew after a change, where the others stand: make fuzz AGAIN="rssr loop"
AGAIN ?=
.PHONY: fuzz
fuzz: $(VENV)/.installed-dev  ## Hard use: LINKAGES, FILES, THREADS, SEED, AGAIN; writes docs/hard-use.md
	$(BIN)/python -m evidence.fuzz run --page --linkages $(LINKAGES) --files $(FILES) --threads $(THREADS) --seed $(SEED) $(if $(AGAIN),--again $(AGAIN))

.PHONY: clean
clean:  ## Remove all that these commands made, the environment too
	rm -rf $(VENV) target build dist demo .mypy_cache .ruff_cache .pytest_cache .hypothesis
	rm -f python/sevenbar/_core*.so
	find python tests evidence examples -name __pycache__ -prune -exec rm -rf {} +

# The environment: each stamp stands for a step that is done and need not be done again.

$(BIN)/pip:
	@command -v $(PYTHON) >/dev/null || { echo "no $(PYTHON) found; install Python 3.11 or later, or name one: make PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit("Sevenbar needs Python 3.11 or later and $(PYTHON) is %d.%d; name another: make PYTHON=..." % sys.version_info[:2] if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.maturin: pyproject.toml | have-cargo $(BIN)/pip
	$(BIN)/pip install $$($(BIN)/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"])')
	@touch $@

# installed in place: a change of a Python file needs no new build
$(VENV)/.installed: $(VENV)/.maturin $(RUST) $(LOST)
	$(BIN)/maturin develop --release $(LOCKED)
	@touch $@

$(VENV)/.installed-dev: $(VENV)/.maturin $(RUST) $(LOST)
	$(BIN)/maturin develop --release $(LOCKED) --extras dev
	@touch $(VENV)/.installed $@

# half a minute, so anew only where the core or its stub has changed
$(VENV)/.stub-checked: $(VENV)/.installed-dev python/sevenbar/_core.pyi pyproject.toml
	$(BIN)/stubtest --mypy-config-file pyproject.toml sevenbar._core
	@touch $@

# with what the notebooks and the examples of docstrings use
$(VENV)/.installed-docs: $(VENV)/.maturin $(RUST) $(LOST)
	$(BIN)/maturin develop --release $(LOCKED) --extras docs,calibrate,design,frame,law,sweep
	@touch $(VENV)/.installed $@

# for the tests in a browser, which fail without it; all others run on
.PHONY: have-chromium
have-chromium:
	@for name in chromium chromium-browser google-chrome; do command -v $$name >/dev/null && exit; done; \
	  [ "$$(id -u)" = 0 ] || as="sudo -n"; \
	  command -v apt-get >/dev/null && echo "installing chromium through apt" && \
	  { $$as apt-get -qq update; $$as apt-get -qq --yes install chromium; } </dev/null >/dev/null 2>&1 || \
	  echo "no Chromium, so the tests in a browser will fail; install it: apt-get install chromium" >&2

.PHONY: have-cargo lost-core
have-cargo:
	@command -v cargo >/dev/null || { echo "no cargo found; install Rust 1.89 or later (https://rustup.rs) and open a new shell" >&2; exit 1; }
lost-core:
