# The front door: `make run` and `make test` do all the set-up themselves.
BUILD ?= build
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
CTEST_FLAGS ?=
# The standard library's checks of indices in our objects (docs/change/decisions/0009-library-assertions-in-ci.md): .ci/run turns them on.
ASSERTIONS ?= OFF
# A first build reads other people's headers once (cmake/precompiled.cmake), compiles several sources as one (cmake/unity.cmake),
# and by Ninja, where it is, which lets no core wait while a library is linked; a folder keeps what it began with.
FIRST = $(if $(wildcard $(BUILD)/CMakeCache.txt),,-DSPARSHA_PRECOMPILE=ON -DSPARSHA_UNITY=ON $(if $(shell command -v ninja),-G Ninja))

.PHONY: run test tests package docs setup setup-run setup-package nightly bench bench-quick soak format clean

run: setup-run
	@cmake -S . -B $(BUILD) -DCMAKE_BUILD_TYPE=Release -DSPARSHA_LIBRARY_ASSERTIONS=$(ASSERTIONS) $(FIRST) > $(BUILD)-configure.log 2>&1 \
	  || { cat $(BUILD)-configure.log; exit 1; }
	@rm -f $(BUILD)-configure.log
	cmake --build $(BUILD) -j$(JOBS) --target sparsha_runnable
	@tools/main-job.sh $(BUILD)

tests: setup
	cmake -S . -B $(BUILD) -DCMAKE_BUILD_TYPE=Release -DSPARSHA_BUILD_TESTS=ON -DSPARSHA_LIBRARY_ASSERTIONS=$(ASSERTIONS) $(FIRST)
	cmake --build $(BUILD) -j$(JOBS)

test: tests
	ctest --test-dir $(BUILD) -j$(JOBS) --output-on-failure --no-tests=error $(CTEST_FLAGS)

# Same sources, same bytes: times in the packages are that of the last commit.
package: export SOURCE_DATE_EPOCH ?= $(shell git log -1 --format=%ct 2>/dev/null || echo 0)
package: setup-package
	cmake -S . -B $(BUILD) -DCMAKE_BUILD_TYPE=Release $(FIRST)
	cmake --build $(BUILD) -j$(JOBS) --target sparsha_packaged
	cd $(BUILD) && cpack
	cp $(BUILD)/*.deb $(BUILD)/sparsha-*.tar.gz .

docs:
	@tools/setup.sh packages-docs.txt
	@tools/docs.sh $(BUILD)

setup:
	@tools/setup.sh packages.txt

setup-run:
	@tools/setup.sh packages.txt run

setup-package:
	@tools/setup.sh packages.txt package

nightly: setup
	@tools/nightly.sh

soak: setup
	cmake -S . -B $(BUILD) -DCMAKE_BUILD_TYPE=Release -DSPARSHA_LIBRARY_ASSERTIONS=$(ASSERTIONS)
	cmake --build $(BUILD) -j$(JOBS) --target haptics_soak
	$(BUILD)/bin/haptics_soak 100000000

bench: setup
	@tools/setup.sh packages-bench.txt
	@tools/bench.sh $(BUILD) full

bench-quick: setup
	@tools/bench.sh $(BUILD) quick

format:
	git ls-files '*.h' '*.cpp' | xargs clang-format -i

clean:
	rm -rf $(BUILD)
