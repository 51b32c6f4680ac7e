# The two commands of this project are `make demo` and `make test`. Each installs what is missing first.
.PHONY: build demo test bench format clean dependencies

# The programs; `make test` builds the tests.
build: dependencies
	cmake --preset release
	cmake --build --preset release --target culprit sunset-node

demo: build
	build/release/bin/culprit demo --end

test: dependencies
	scripts/test

bench: build
	cmake --preset release -DCULPRIT_BENCH=ON
	cmake --build --preset release --target culprit-bench
	build/release/bin/culprit-bench

format:
	git ls-files '*.h' '*.cpp' | xargs clang-format -i

clean:
	rm -rf build

dependencies:
	@scripts/install-dependencies
