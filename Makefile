# make demo   a part is machined by the ROS graph: runs/demo.mcap and runs/demo.html; LOOK=1: pages of it in a browser
# make test   the tests; LONG=1: with those that take long;  make lint: ruff and mypy;  make setup: the set-up alone
# make bench   figures; it never fails on time
# make campaign   kills, load, random commands, mutated inputs: 9 minutes; HOURS=8 longer, SEED=7 other ones
# make figures   every scenario of examples/figures runs and becomes a picture in docs/figures
# make docs   reference pages and gallery are made again, then the site: build/site/index.html
# make ids   cnc_ptp/parameters/declare/ids.py is made from declarations.yaml
# make setup LOCKED=1   the versions of requirements.lock, whose files must have the hashes there (Python 3.11)
# make lock   requirements.lock: every package of make setup with its version and hashes, for Python 3.11
# make audit   known vulnerabilities and licences of these packages;  make sbom: build/sbom.json lists them (CycloneDX)
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
REQUIREMENTS := requirements-build.txt requirements.txt requirements-test.txt
INTERFACES := $(wildcard msg/*.msg srv/*.srv action/*.action)
PACKAGE := setup.py setup.cfg CMakeLists.txt package.xml
SOURCES := $(shell find cnc_ptp -name '*.py' -not -path '*/msg/*' -not -path '*/srv/*' -not -path '*/action/*')

# Compiled bytecode is kept, whatever the environment says: every process of the graph is faster to start.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: setup demo test lint bench campaign figures docs ids lock audit sbom clean
setup: $(VENV)/.package $(VENV)/.kernel

$(VENV)/.python:
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' || \
	  { echo "cnc_ptp needs Python 3.11, 3.12 or 3.13; $$($(PYTHON) --version) was found. Call: make PYTHON=python3.12 ..."; exit 2; }
	@$(PYTHON) -m venv $(VENV) || \
	  { rm -rf $(VENV); echo "The virtual environment could not be made. On Debian and Ubuntu: apt-get install python3-venv python3-dev"; exit 2; }
	@touch $@

# What was installed from the lock file stays so.
LOCKED ?= $(wildcard $(VENV)/.requirements-locked)
INSTALLED := $(VENV)/.requirements$(if $(LOCKED),-locked)
$(INSTALLED): $(REQUIREMENTS) $(if $(LOCKED),requirements.lock) $(VENV)/.python
	@echo "Installing ROS 2 and the other packages into $(VENV) (1 to 4 minutes) ..."
	@$(BIN)/pip install --quiet --disable-pip-version-check \
	  $(if $(LOCKED),--require-hashes -r requirements.lock,$(addprefix -r ,$(REQUIREMENTS)))
	@rm -f $(VENV)/.requirements $(VENV)/.requirements-locked && touch $@

$(VENV)/.package: $(PACKAGE) $(INTERFACES) $(INSTALLED)
	@echo "Generating the ROS interfaces, compiling the kernel and installing cnc_ptp into $(VENV) (about 500 files, 2 to 8 minutes on two cores) ..."
	@$(BIN)/python tools/build_progress.py build $(BIN)/pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps --editable .
	@touch $@

# Without a C compiler the kernel runs interpreted; the program says why. A library that is gone is made again.
ifeq ($(wildcard cnc_ptp/compiled/library/*.so),)
.PHONY: $(VENV)/.kernel
endif
$(VENV)/.kernel: $(SOURCES) pyproject.toml $(VENV)/.package
	@CNC_PTP_PURE=1 $(BIN)/python tools/build_progress.py build $(BIN)/python -m cnc_ptp.compiled.build > build/kernel.log && touch $@ || true

demo: setup
	@mkdir -p runs
	$(BIN)/cnc_ptp run config/mill.yaml --program examples/bracket.nc --scenario examples/bracket_overrides.yaml --record runs/demo.mcap
	$(BIN)/cnc_ptp report runs/demo.mcap -o runs/demo.html
	@echo "The report is runs/demo.html. Pages of this run in a browser, http://localhost:8080: make demo LOOK=1, or $(BIN)/cnc_ptp web runs/demo.mcap"
	$(if $(LOOK),$(BIN)/cnc_ptp web runs/demo.mcap)

# Without LONG=1, tests that are marked as long are left out. -n 1: a process in which a test hangs is replaced.
SHORT := $(if $(LONG),,-m "not long")

test: setup
	$(BIN)/pytest -n 2 --dist worksteal --ignore test/graph $(SHORT)
	CNC_PTP_PURE=1 $(BIN)/pytest -n 2 -m interpreted $$(grep -rl --include='*.py' 'mark.interpreted' test)
	$(BIN)/pytest -n 1 test/graph $(SHORT)

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: setup
	$(BIN)/python -m bench
	$(BIN)/python -m bench.against

campaign: setup
	@mkdir -p runs
	$(BIN)/python -m campaign --seed $(or $(SEED),1) $(if $(HOURS),--hours $(HOURS)) --json runs/campaign.jsonl

figures: setup
	$(BIN)/python -m figures

$(VENV)/.docs: requirements-docs.txt $(INSTALLED)
	@$(BIN)/pip install --quiet --disable-pip-version-check -r requirements-docs.txt
	@touch $@

docs: setup $(VENV)/.docs
	$(BIN)/python -m cnc_ptp.parameters.declare.reference > docs/parameters.md
	$(BIN)/python -m cnc_ptp.commands.reference > docs/commands.md
	$(BIN)/python -m cnc_ptp.commands.hli_reference > docs/hli_objects.md
	$(BIN)/python -m cnc_ptp.commands.language.reference > docs/nc_language.md
	$(BIN)/python -m cnc_ptp.commands.language.reference iso > docs/iso_language.md
	$(BIN)/python -m cnc_ptp.commands.language.grammar > tools/nc.tmLanguage.json
	$(BIN)/python -m cnc_ptp.commands.machine_schema > tools/machine.schema.json
	$(BIN)/python -m cnc_ptp.commands.scenario_schema > tools/scenario.schema.json
	$(BIN)/python -m cnc_ptp.catalogue.collect > build/texts.yaml && cp build/texts.yaml cnc_ptp/catalogue/texts.yaml
	$(BIN)/python -m cnc_ptp.catalogue.reference > docs/errors.md
	$(BIN)/python -m figures.gallery > docs/gallery.md
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going -d build/site-cache docs build/site

ids: setup
	$(BIN)/python cnc_ptp/parameters/declare/make_ids.py

# The tools are apart from what they look at: none of their packages is in its list.
AUDIT := .venv-audit

$(AUDIT)/.tools: requirements-audit.txt
	@$(PYTHON) -m venv $(AUDIT) && $(AUDIT)/bin/pip install --quiet --disable-pip-version-check -r requirements-audit.txt
	@touch $@

lock: $(AUDIT)/.tools
	$(AUDIT)/bin/uv pip compile --quiet --generate-hashes --python-version 3.11 --no-header --no-emit-index-url \
	  --output-file requirements.lock $(REQUIREMENTS)

# Of the vulnerabilities only those of locked versions count; licences are those of what is installed.
audit: setup $(AUDIT)/.tools
	@mkdir -p build
	$(AUDIT)/bin/pip-licenses --python $(BIN)/python --format markdown --order license --output-file build/licences.md \
	  --partial-match --fail-on "AGPL;SSPL;Affero"
	@echo "Licences by package: build/licences.md"
	@rm -f build/audit.json
	-$(AUDIT)/bin/pip-audit --requirement requirements.lock --require-hashes --disable-pip --format json --output build/audit.json
	$(BIN)/python tools/audit_result.py build/audit.json

sbom: $(AUDIT)/.tools
	@mkdir -p build
	$(AUDIT)/bin/cyclonedx-py requirements --output-reproducible --output-file build/sbom.json requirements.lock
	$(PYTHON) tools/sbom_web.py build/sbom.json

clean:
	rm -rf $(VENV) $(AUDIT) build *.egg-info cnc_ptp/msg cnc_ptp/srv cnc_ptp/action cnc_ptp/*.so cnc_ptp/compiled/library
