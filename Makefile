# The two commands of this project are `make demo` and `make test`. Each installs what is missing first.
.PHONY: build install package demo test soak bench docs format clean

# Ninja would start two compilers more than there are processors; on two cores that takes a tenth longer.
JOBS := $(shell nproc)

# The programs that the README runs; `make test` builds the tests.
build:
	@scripts/install-dependencies --studies
	cmake --preset release -DCULPRIT_TESTS=OFF
	cmake --build --preset release --parallel $(JOBS) --target culprit culprit-lab sunset-node suave-node rover-node

# Programs, rules, documents, the manual page, and culprit::core for programs of others.
PREFIX ?= /usr/local
install: build
	cmake --install build/release --strip --prefix $(PREFIX)

# Debian packages: build/packages/; with ARCH=arm64 those for arm64: build/packages-arm64/.
package:
	@scripts/install-dependencies --packages$(if $(ARCH),-$(ARCH))
	scripts/package $(if $(ARCH),--arch $(ARCH))

# At a terminal the robot flies on until Ctrl-C, so that its page can be opened; in a pipe it ends by itself.
demo:
	@scripts/install-dependencies
	cmake --preset demo
	cmake --build --preset demo --parallel $(JOBS)
	build/demo/bin/culprit-lab demo

test:
	@scripts/install-dependencies --test-builds
	scripts/test

# What takes longer than a test may, some six hours in all: all tests as users build, a robot that is broken and healed for an hour, three robots that nothing
# is wrong with for ten minutes each, recordings with 100 planted faults, 500 kills of culprit, drills of three robots and drills that are killed, 67 attacks 20 times each, 1,000 robots of a fleet, 100 random sequences of faults for each kind of
# owner, 40 changes of the core that its tests should notice, the laboratory and the commands under the address sanitizer, all but robots, laboratory and
# commands under the thread sanitizer, each file compiled by itself, each fuzzer for five minutes, every figure in the documents that its command makes again, the commands of the tutorial,
# Debian packages that are installed, upgraded and removed, and clang-tidy on every file.
soak:
	@scripts/install-dependencies --tests
	cmake --preset release
	cmake --build --preset release --parallel $(JOBS)
	ctest --preset release --parallel 4
	scripts/soak
	scripts/first-hour
	scripts/healthy --seconds 600
	scripts/bag-trial
	scripts/chaos
	scripts/drill-trial
	scripts/hostile
	CULPRIT_ROBOTS=1000 build/release/bin/fleet_test --gtest_filter='Fleet.CountsAreTheSum*'
	CULPRIT_SEQUENCES=100 build/release/bin/owners_test --gtest_filter='AnySequenceOfFaults.*'
	scripts/mutate
	cmake --preset asan
	cmake --build --preset asan-soak --parallel $(JOBS)
	ctest --preset asan-soak
	cmake --preset tsan
	cmake --build --preset tsan --parallel $(JOBS)
	ctest --preset tsan
	cmake --preset walls
	cmake --build --preset walls-soak --parallel $(JOBS)
	scripts/fuzz --seconds 300
	scripts/figures --check
	scripts/pictures --check
	scripts/install-dependencies --arm64
	scripts/arm64
	scripts/install-dependencies --packages
	scripts/test-packages
	scripts/tidy

# The documents as a site that can be searched: build/docs/index.html. It needs no network.
docs:
	@scripts/install-dependencies --docs
	sphinx-build -q -W --keep-going -c docs/site docs build/docs

bench:
	@scripts/install-dependencies --tests
	cmake --preset release -DCULPRIT_BENCH=ON
	cmake --build --preset release --parallel $(JOBS) --target culprit-bench
	build/release/bin/culprit-bench

format:
	git ls-files '*.h' '*.cpp' | xargs clang-format -i

clean:
	rm -rf build
