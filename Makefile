# Every target sets up what it needs: .venv with the pinned packages of constraints.txt,
# or, to test the declared ranges, .venv-oldest and .venv-newest, each time from nothing.
PYTHON ?= python3
ifeq ($(OS),Windows_NT)
SCRIPTS := Scripts
else
SCRIPTS := bin
endif
BIN := .venv/$(SCRIPTS)
READY := .venv/ready

.PHONY: help figures redraw gallery book course test test-fast test-long test-browser test-book test-oldest \
	test-newest notebooks explore bench lint clean

help:
	@echo "make figures       run every notebook and redraw figures/"
	@echo "make gallery       draw figures/gallery/: twelve nets and the lines that make them"
	@echo "make book          the book, to be read in any browser: book/_build/html/index.html"
	@echo "make course        the notebooks to hand out, and with solutions (FOLDER=... for your own)"
	@echo "make test          all tests but those in a browser, every notebook rerun"
	@echo "make test-fast     the tests without notebooks, programs that are started, other processors"
	@echo "make test-long     what other processors would draw, in all settings; half an hour"
	@echo "make test-browser  the explorer in Chromium; installs it on Debian and Ubuntu"
	@echo "make test-book     the book, every page of it, in Chromium with no network"
	@echo "make test-oldest   all tests with every declared package at its lower bound"
	@echo "make test-newest   all tests with the newest packages, whatever they are today"
	@echo "make explore       turn the angles of nets in your browser (FILE=surface.obj for your own)"
	@echo "make notebooks     open the notebooks in JupyterLab, on this machine only"
	@echo "make bench         seconds, memory and accuracy of the optimisation, some minutes"
	@echo "make lint          ruff: format and lint; mypy: the types in the library"
	@echo "make clean         remove the environments"

$(READY): pyproject.toml constraints.txt tools/setup.py
	$(PYTHON) tools/setup.py

figures: $(READY)
	$(MAKE) --jobs=2 gallery redraw

redraw: $(READY)
	$(BIN)/python tools/redraw.py

gallery: $(READY)
	$(BIN)/python tools/gallery.py

book: $(READY)
	$(BIN)/python book/build.py

course: $(READY)
	$(BIN)/python tools/course.py $(if $(FOLDER),"$(FOLDER)")

test: $(READY)
	$(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder -m "not browser"

test-fast: $(READY)
	$(BIN)/python -m pytest -p no:nbmake -n auto --dist loadfile --no-loadscope-reorder -m "not (notebook or program or browser or elsewhere)"

test-long: $(READY)
	$(BIN)/python -m pytest -m "long or elsewhere" --long -n auto --dist load

test-browser: $(READY)
	$(BIN)/python tools/browser.py
	$(BIN)/python -m pytest tests/test_browser_run.py tests/test_browser*.py -m "browser and not alone" -rs -n auto --dist loadfile --no-loadscope-reorder
	$(BIN)/python -m pytest tests/test_browser*.py -m "browser and alone" -rs

test-book: book
	$(BIN)/python tools/browser.py
	$(BIN)/python -m pytest --book -m book -rs -n auto

test-oldest test-newest: test-%:
	$(PYTHON) tools/setup.py --versions $*
	.venv-$*/$(SCRIPTS)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder

notebooks: $(READY)
	$(BIN)/python -m jupyter lab --ServerApp.ip=127.0.0.1 notebooks/0_start_here.ipynb

explore: $(READY)
	$(BIN)/python -m inetlib.explorer $(if $(FILE),"$(FILE)")

bench: $(READY)
	$(BIN)/python bench/bench_solver.py
	$(BIN)/python bench/random_patches.py
	$(BIN)/python bench/random_surfaces.py

lint: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check .
	$(BIN)/mypy

clean:
	$(PYTHON) tools/setup.py --remove
