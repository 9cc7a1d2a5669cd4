# The front door of robot_cloth; `make help` lists what there is. Everything here calls cmake, ctest and
# roslaunch, which work just as well without it.
SHELL := /bin/bash
# ROS needs the system's python: keep a pyenv's or conda's behind it
export PATH := /usr/bin:/bin:$(PATH)

BUILD ?= build
JOBS ?= $(shell nproc)
PYTHON := /usr/bin/python3
CMAKE_OPTIONS ?=
# only where the build folder is new: a generator cannot be changed later
GENERATOR := $(if $(wildcard $(BUILD)/CMakeCache.txt),,$(if $(shell command -v ninja),-G Ninja))
SANITIZE_GENERATOR := $(if $(wildcard $(BUILD)/sanitize/CMakeCache.txt),,$(if $(shell command -v ninja),-G Ninja))

.PHONY: help demo picture test test-gpu bench validate accuracy stability effects install-packages build build-tests build-sanitize clean

help:             ## this list
	@grep -hE '^[a-z-]+: .*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## /  make \1\t/' | expand -t 26

demo: build       ## install what is missing, build, and let the robot fold a towel (RViz if there is a display)
	src/demo/with_ros.sh $(BUILD) roslaunch robot_cloth fold.launch $(DEMO)

picture: build    ## render the demo in RViz without a display: $(BUILD)/pictures/*.png
	src/demo/picture.sh $(BUILD) $(BUILD)/pictures

test: build-tests build-sanitize ## build and run every test; closes with "N passed, N failed"
	$(PYTHON) test/run_tests.py $(BUILD) $(BUILD)/sanitize

test-gpu: build  ## what needs a GPU: its tests against the CPU, compute-sanitizer, large scenes
	test/gpu.sh $(BUILD)

bench: build      ## median and spread per stage on the demo's scenes
	test/bench/run.sh $(BUILD)

validate: build   ## hold the engine against known answers; rewrites doc/validation.md and its figures
	$(BUILD)/test/cloth_validate --out $(BUILD)/validation.csv; missed=$$?; \
	  $(PYTHON) test/validate/plot.py $(BUILD)/validation.csv doc && exit $$missed

accuracy: build   ## what accuracy costs: sweeps config/accuracy, CSV, plots and lists to $(BUILD)/accuracy; goes on where it was
	$(BUILD)/cloth accuracy config/accuracy/*.yaml --threads 1 --out $(BUILD)/accuracy --cost cpu $(ACCURACY)
	$(PYTHON) src/tool/plot_accuracy.py $(BUILD)/accuracy/accuracy.csv --cost cpu

stability: build  ## hard cases and 1,000 random scenes; goes on where it was; rewrites the tables of doc/stability.md
	OMP_NUM_THREADS=1 $(PYTHON) test/stability/run.py $(BUILD)/cloth --out $(BUILD)/stability --jobs $(JOBS) --seeds 1000 \
	  --doc doc/stability.md $(STABILITY)

effects: build    ## the price of each effect, with it and without it; rewrites doc/effects.md
	$(PYTHON) test/bench/effects.py $(BUILD) $(EFFECTS)

install-packages: ## install the Debian packages that are missing (root or sudo)
	src/demo/install_packages.sh

build: install-packages ## configure and build into $(BUILD)
	cmake -S . -B $(BUILD) $(GENERATOR) -DPYTHON_EXECUTABLE=$(PYTHON) -DPython3_EXECUTABLE=$(PYTHON) $(CMAKE_OPTIONS)
	cmake --build $(BUILD) -j $(JOBS)

# gtest and rostest programs are built by catkin's target `tests` only
build-tests: build
	@if cmake --build $(BUILD) --target help | grep -qE '(^|[^a-z_])tests(:|$$)'; then \
	  cmake --build $(BUILD) --target tests -j $(JOBS); fi

# the unit tests again, under the address and undefined-behaviour sanitizers; ROS is not instrumented
build-sanitize: install-packages
	cmake -S . -B $(BUILD)/sanitize $(SANITIZE_GENERATOR) -DCMAKE_BUILD_TYPE=Debug -DCLOTH_ROS=OFF -DCLOTH_CUDA=OFF \
	  -DCLOTH_SANITIZE=address,undefined -DPYTHON_EXECUTABLE=$(PYTHON) -DPython3_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)/sanitize -j $(JOBS)

clean:            ## remove $(BUILD)
	rm -rf $(BUILD)
