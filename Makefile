# Commands of Caustica. Everything is built in release mode, so that nothing is compiled twice.

CARGO ?= cargo
CARGO_TARGET_DIR ?= target
PROGRAM := $(CARGO_TARGET_DIR)/release/caustica
PICTURE := out/teapot_pool.png

# Without a session, Mesa's device selection prints an error at every start. The program switches it off itself; this is for the test
# binaries.
ifndef XDG_RUNTIME_DIR
export NODEVICE_SELECT ?= 1
endif

.DEFAULT_GOAL := build
.PHONY: demo build test nightly lint bench docs mutants fuzz fuzz-deps clean deps

# Render the example scene.
demo: build
	@mkdir -p $(dir $(PICTURE))
	$(PROGRAM) render scenes/teapot_pool.json -o $(PICTURE)
	@echo "The picture is $(abspath $(PICTURE))"

# Compile the program.
build: deps
	$(CARGO) build --release --locked

# Run all tests; those on the GPU use a software driver if there is no other.
test: deps
	$(CARGO) test --release --locked

# Run all tests with many more random scenes and frames; about half an hour on two cores.
nightly: deps
	CAUSTICA_PROPERTY_CASES=2000 CAUSTICA_RENDERS=10000 $(CARGO) test --release --locked

# Check formatting and lints; warnings are errors.
lint: deps
	@./deploy/install-deps.sh --lint
	$(CARGO) fmt --check
	$(CARGO) clippy --release --locked --all-targets -- -D warnings

# Run the benchmarks.
bench: deps
	$(CARGO) bench --locked --bench caustica

# Measure error and time of each dial, and write docs/accuracy.md, docs/level-maps.md, docs/sea.md, docs/waves.md, docs/methods.md and docs/hard-cases.md; one to two hours on an idle machine.
docs: deps
	$(CARGO) run --release --locked --example make_docs

# Seconds that each fuzz target runs.
FUZZ_SECONDS ?= 60

# Fuzz the readers of scenes, meshes and fields; inputs that break them are kept in fuzz/artifacts. The first build takes minutes.
# cargo-fuzz requests coverage by an unstable compiler flag: hence RUSTC_BOOTSTRAP. No sanitizer: our code has no unsafe blocks.
fuzz: fuzz-deps
	$(CARGO) run --release --locked --example fuzz_seeds -- fuzz/corpus
	RUSTC_BOOTSTRAP=1 $(CARGO) fuzz run --sanitizer none obj -- -max_total_time=$(FUZZ_SECONDS) -timeout=10 -max_len=16384
	RUSTC_BOOTSTRAP=1 $(CARGO) fuzz run --sanitizer none field -- -max_total_time=$(FUZZ_SECONDS) -timeout=10 -max_len=16384
	RUSTC_BOOTSTRAP=1 $(CARGO) fuzz run --sanitizer none scene -- -max_total_time=$(FUZZ_SECONDS) -timeout=10 -max_len=16384

fuzz-deps: deps
	@$(CARGO) fuzz --version >/dev/null 2>&1 || $(CARGO) install cargo-fuzz --version ^0.13 --locked

# Plant errors in shaders and in a copy of the sources, check that hard cases and tests catch each, and write docs/mutants.md; half an hour.
mutants: deps
	$(CARGO) run --release --locked --example mutants

# Remove all build products and pictures.
clean:
	$(CARGO) clean
	rm -rf out

# Install missing system packages.
deps:
	@./deploy/install-deps.sh --build --run
