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
ENGINE := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock

.PHONY: help setup demo test test-rust test-python check bench docs clean

help: ## Show what there is
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

setup: .venv/installed ## Build .venv with the engine compiled in release

.venv/installed: pyproject.toml $(ENGINE)
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/pip install -q -e ".[dev]"
	touch $@

demo: .venv/installed ## Learn a simulated cell, break it, name the fault
	$(BIN)/runglight demo

test: test-rust test-python ## All tests

test-rust:
	cargo test --release --workspace

test-python: .venv/installed
	$(BIN)/pytest

check: .venv/installed ## Lints, types and formatting
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
	rm -rf .venv target demo-out benches/c/build benches/plat_baseline/build benches/results
