# Caustica: what to type. Everything is built in release mode: there is one profile, so nothing is compiled twice.

CARGO ?= cargo
CARGO_TARGET_DIR ?= target
PROGRAM := $(CARGO_TARGET_DIR)/release/caustica
PICTURE := out/teapot_pool.png

# Without a session to look for a display in, Mesa's device selection prints errors at every start; it has nothing to select.
ifndef XDG_RUNTIME_DIR
export NODEVICE_SELECT ?= 1
endif

.DEFAULT_GOAL := build
.PHONY: demo build test nightly lint bench docs mutants clean deps

# Render the example scene.
demo: build
	@mkdir -p $(dir $(PICTURE))
	$(PROGRAM) render scenes/teapot_pool.json -o $(PICTURE)
	@echo "The picture is $(abspath $(PICTURE))"

# Compile the program.
build: deps
	$(CARGO) build --release --locked

# Run all tests; those on the GPU use a software driver where there is no other.
test: deps
	$(CARGO) test --release --locked

# Run all tests with many more random scenes and frames; some hours.
nightly: deps
	CAUSTICA_PROPERTY_CASES=2000 CAUSTICA_RENDERS=10000 $(CARGO) test --release --locked

# Check formatting, and let no warning pass.
lint: deps
	$(CARGO) fmt --check
	$(CARGO) clippy --release --locked --all-targets -- -D warnings

# Measure.
bench: deps
	$(CARGO) bench --locked --bench caustica

# Measure what each dial buys, and write docs/accuracy.md, docs/level-maps.md and docs/hard-cases.md; an hour or two on a quiet machine.
docs: deps
	$(CARGO) run --release --locked --example make_docs

# Plant wrong signs in a copy of the sources, see that the tests catch each, and write docs/mutants.md; half an hour.
mutants: deps
	$(CARGO) run --release --locked --example mutants

# Remove everything that was made.
clean:
	$(CARGO) clean
	rm -rf out

# Install what is missing on this machine.
deps:
	@./deploy/install-deps.sh --build --run
