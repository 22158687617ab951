# Every recipe works from a fresh clone: the environment is built when it is first needed.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help

export PATH := $(HOME)/.cargo/bin:$(PATH)
# One target directory, so that the wheel's engine and the Rust tests share their compilation.
export CARGO_TARGET_DIR ?= $(CURDIR)/target
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_ROOT_USER_ACTION := ignore

PYTHON ?= python3
BIN := .venv/bin
PAGE := python/runglight/server/page/index.html
PAGE_SOURCES := $(shell find web/src web/public -type f) $(addprefix web/,index.html package.json package-lock.json svelte.config.js tsconfig.json vite.config.ts)
# The page is built with Node 20 or newer; without it everything else works.
HAS_NODE := $(shell node -e 'process.exit(parseInt(process.versions.node) >= 20 ? 0 : 1)' 2>/dev/null && npm --version >/dev/null 2>&1 && echo yes)
# Spark runs on Java 17 or newer, and Maven fetches Kafka for its tests; without them they are skipped.
HAS_JAVA := $(shell java -version 2>&1 | grep -Eq 'version "(1[7-9]|[2-9][0-9])' && command -v mvn >/dev/null && echo yes)
SPARK := $(if $(HAS_JAVA),.venv/spark)
ENGINE := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock

.PHONY: help setup page demo test test-rust test-python test-page check check-page bench docs clean

help: ## Show what there is
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

setup: page .venv/installed ## Build the page, and .venv with the engine compiled in release

ifeq ($(HAS_NODE),yes)
page: $(PAGE) ## Build the web page (needs Node 20)
else
page:
	@echo "no Node 20 here: the page is not built, everything else is; install Node and run make page" >&2
endif

# Not committed: it is built before the package that it goes into.
$(PAGE): web/node_modules/.package-lock.json $(PAGE_SOURCES)
	cd web && npm run --silent build -- --logLevel warn
	touch $@

web/node_modules/.package-lock.json: web/package-lock.json
	cd web && npm ci --no-audit --no-fund --loglevel=error
	touch $@

.venv/installed: pyproject.toml $(ENGINE)
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/pip install -q -e ".[dev]"
	touch $@

# Half a gigabyte, which only the tests need.
.venv/spark: pyproject.toml | .venv/installed
	$(BIN)/pip install -q -e ".[spark,kafka]"
	touch $@

demo: page .venv/installed ## Learn a simulated cell, break it, name the fault, show the page
	$(BIN)/runglight demo

test: test-rust page test-page test-python ## All tests

test-rust:
	cargo test --release --workspace

test-python: .venv/installed $(SPARK)
	$(BIN)/pytest

ifeq ($(HAS_NODE),yes)
test-page: $(PAGE)
	cd web && npm test --silent

check-page: $(PAGE)
	cd web && npm run --silent check
else
test-page check-page:
	@echo "no Node 20 here: the page is not tested" >&2
endif

check: .venv/installed check-page ## Lints, types and formatting
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python docs/generate.py --check
	$(BIN)/python -m benches.page --check
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --release -- -D warnings

bench: .venv/bench ## Speed, memory and accuracy beside the paper's; writes docs/reference/benchmarks.md
	$(BIN)/python -m benches.run --publish

.venv/bench: .venv/installed
	$(BIN)/pip install -q -e ".[bench]"
	touch $@

docs: .venv/installed ## Write the generated pages of docs/reference
	$(BIN)/python docs/generate.py

clean: ## Remove what was built
	rm -rf .venv target demo-out web/node_modules python/runglight/server/page benches/c/build benches/plat_baseline/build benches/results
