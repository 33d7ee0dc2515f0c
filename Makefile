# Everything runs in .venv, which is made on first use and whenever the requirements change.

PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed
DOCS_STAMP := .venv/.installed-docs
PLUGINS := $(wildcard plugins/*)

.PHONY: install demo test test-slow test-browser fuzz fuzz-page lint format docs pages benchmark constraints clean

install: $(STAMP)

$(STAMP): pyproject.toml constraints.txt $(addsuffix /pyproject.toml,$(PLUGINS))
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "moseg needs Python 3.11 or newer; try 'make PYTHON=python3.12 $(MAKECMDGOALS)'"; exit 1; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check \
		-c constraints.txt -e ".[dev]" $(addprefix -e ./,$(PLUGINS))
	@touch $@

# Segment the sample hammer and show what comes out.
demo: $(STAMP)
	@mkdir -p demo
	$(BIN)/moseg sample hammer -o demo/sample.ply --labels demo/truth.txt
	$(BIN)/moseg segment demo/sample.ply --recipe hammer \
		-o demo/hammer.glb -o demo/hammer.ply -o demo/hammer.json -o demo/hammer.png -o demo/hammer.html
	@echo
	$(BIN)/moseg evaluate demo/sample.ply demo/hammer.json demo/truth.txt

test: $(STAMP)
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow and not browser and not fuzz"

test-slow: $(STAMP)
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "slow and not browser and not fuzz"

# Hostile files of all formats, under limits; prints what became of them.
fuzz: $(STAMP)
	$(BIN)/python -m pytest -s -m fuzz tests/fuzz

# The table of that on docs/promises.md.
fuzz-page: $(STAMP)
	$(BIN)/python -m tests.fuzz.page

# Pages in Chromium; without it the tests are skipped, unless MOSEG_BROWSER is "required".
test-browser: $(STAMP) .venv/.browser
	$(BIN)/python -m pytest tests/browser

.venv/.browser: $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check \
		-c constraints.txt -e ".[browser]"
	@touch $@

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/mypy examples
	$(BIN)/lint-imports

format: $(STAMP)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# The site, in build/docs; what it is made of beside docs/*.md is in docs/conf.py.
docs: $(DOCS_STAMP)
	$(BIN)/sphinx-build -b html -j 2 -W --keep-going -q docs build/docs
	@echo "build/docs/index.html"

$(DOCS_STAMP): $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[docs]"
	@touch $@

# The pages that are made from the code; tests compare.
pages: $(STAMP)
	$(BIN)/python tools/make_component_docs.py
	$(BIN)/python tools/make_check_docs.py
	$(BIN)/python tools/make_cli_docs.py

benchmark: $(STAMP)
	$(BIN)/python benchmarks/speed.py

# Needs uv. No lock file: those name the host that the packages came from.
constraints:
	echo "# Versions that the test suite runs with; made by 'make constraints'." > constraints.txt
	uv pip compile --universal --quiet --no-header --no-annotate --no-emit-index-url \
		--no-emit-find-links --python-version 3.11 --extra dev --extra browser --extra docs --no-emit-package moseg-core \
		pyproject.toml $(addsuffix /pyproject.toml,$(PLUGINS)) >> constraints.txt

clean:
	rm -rf .venv build demo dist docs/gallery docs/generated .mypy_cache .pytest_cache .ruff_cache .hypothesis
