# auvid: build, test, check. `make help` lists the targets.
#
# Nothing here names a module: a new one is a new .c and a new .h. One file for everything, so that
# make sees all dependencies at once. A single target is made with all cores (JOBS=1 for one);
# several on one line are made in their order. V=1 shows the commands.

ifeq ($(origin CC),default)
CC := gcc
endif
ifeq ($(origin CXX),default)
CXX := g++
# clang takes half of gcc's time for Eigen's templates.
EIGEN_CXX := $(if $(shell command -v clang++),clang++,g++)
endif
EIGEN_CXX ?= $(CXX)
JOBS ?= $(shell nproc)
ifeq ($(word 2,$(MAKECMDGOALS)),)
MAKEFLAGS += --no-builtin-rules -j$(JOBS)
endif
Q := $(if $(V),,@)
.DELETE_ON_ERROR:
.SECONDARY:

# Any other copies of what the tests need: UNITY_DIR holds unity.c and unity.h, EIGEN_DIR holds
# Eigen/Core.
export UNITY_DIR ?= third_party/unity/src
export EIGEN_DIR ?= /usr/include/eigen3
# Tests start Python many times: its byte code is made once, whatever the environment says.
export PYTHONPYCACHEPREFIX := $(CURDIR)/build/python
unexport PYTHONDONTWRITEBYTECODE

LIB := $(wildcard lib/src/*/*.c)
PUBLIC := $(wildcard lib/include/auvid/*.h lib/include/auvid/detail/*.h)
SIMULATOR := $(wildcard tools/simulator/*.c)
PROGRAM := $(wildcard tools/auvid/*.c tools/auvid/*/*.c)
# A real bus needs Linux: elsewhere the program has the bus in memory alone.
MEMORY := $(addprefix port/linux_socketcan/,bus.c bus_memory.c)
PORT := $(if $(filter Linux,$(shell uname -s)),$(wildcard port/linux_socketcan/*.c),$(MEMORY))
PROGRAM := $(if $(filter %/tick.c,$(PORT)),$(PROGRAM),\
    $(filter-out tools/auvid/bus/bus_%,$(PROGRAM)))
# These record which statuses they have seen: see tests/statuses/statuses.py.
RECORDED = $(foreach test,$(UNIT:tests/%.c=release/tests/%) $(VEHICLES:tests/%.c=wide/tests/%),\
    build/$(test))
# What of the program tests run as well: the demo's world.
WORLD := $(wildcard $(addprefix tools/auvid/,base/*.c vehicle/*.c log/c*.c log/log_*.c)) \
    $(filter-out %/doctor_report.c,$(wildcard tools/auvid/doctor/*.c)) \
    $(addprefix tools/auvid/,bus/frames.c bus/world.c field/field_run.c field/field_table.c \
    log/units.c report/report.c report/statistics.c) $(MEMORY)
SUPPORT := $(wildcard tests/support/*.c)
# What of it needs nothing of the program, as on a microcontroller.
SUPPORT_FIRMWARE := $(filter-out %/dive.c,$(SUPPORT))
UNIT := $(wildcard tests/unit/*/test_*.c)
REFERENCE := $(wildcard tests/reference/test_*.cpp)
VEHICLES := $(wildcard tests/vehicles/test_*.c)
VEHICLES_REFERENCE := $(wildcard tests/vehicles/test_*.cpp)
# Golden vectors: see tests/README.md.
GOLDEN_TESTS := build/release/tests/golden/test_core build/wide/tests/golden/test_vehicles
PORT_TESTS := $(wildcard tests/port/test_*.c)
# System calls that tests/port imitates: each __wrap_x() there takes the place of x().
WRAPPED := $(patsubst __wrap_%,-Xlinker --wrap=%,$(sort \
    $(shell grep -o '__wrap_[a-z_]*' tests/port/fake_system.c)))
# Runs of a real vehicle, which are not part of the project; their test runs where they are.
export AUVID_TANK_DATA ?= ../shared/data/bluerov2_tank
NO_TANK := $(if $(wildcard $(AUVID_TANK_DATA)/run_a.csv),,tests/program/test_tank.sh)
SCRIPTS := $(filter-out $(NO_TANK),$(wildcard tests/program/test_*.sh \
    tests/can/test_*.sh))
# The tests of the Python package itself, and other optimizers, are left to the long form.
VALIDATION_SCRIPTS := $(wildcard tests/validation/test_*.sh)
VALIDATION_SHORT := $(filter-out %/test_package.sh %/test_peers.sh,$(VALIDATION_SCRIPTS))
# Ten minutes by the clock, nearly all of them asleep: it begins first, beside the others.
SLEEPER := tests/program/test_realtime.sh
SCRIPTS := $(SLEEPER) $(filter-out $(SLEEPER),$(SCRIPTS))
# Builds of packages (CMake, pkg-config, C++) and with all kinds of flags are left to the long form.
BUILDS := $(addprefix tests/program/test_,drop_in.sh hostile_builds.sh paths_link.sh \
    sizes_derived.sh sizes_link.sh sizes_uncertain.sh threads.sh)
# What needs a real bus, here or in a virtual machine.
VCAN_SCRIPTS := $(wildcard tests/vcan/test_*.sh)
# Of these, what takes minutes of a machine's clock is left to the long form and `make test-vcan`.
VCAN_SHORT := $(filter-out %/test_netem.sh %/test_faults.sh %/test_controllers.sh,$(VCAN_SCRIPTS))
# What runs on emulated microcontrollers: see port/cortex_m/README.md.
BOARD := port/cortex_m/board.sh
BOARDS := $(shell $(BOARD) list)
FIRMWARE_START := $(wildcard port/cortex_m/*.c)
FIRMWARE_EXAMPLE := $(wildcard port/cortex_m/example/*.c)
FIRMWARE_PASSIVE := own_navigation with_filter
FIRMWARE_SCRIPTS := $(wildcard tests/firmware/test_*.sh)
# Mutation tests: the unit tests, or TESTS by name, linked with a changed file of the library.
MUTATION_SCRIPTS := $(wildcard tests/mutation/test_*.sh)
MUTATION_OBJECTS = $(call TESTED,release) build/release/tests/mutation/one_test.c.o
MUTATED_SOURCES := $(if $(TESTS),$(wildcard $(foreach test,$(TESTS),\
    $(addsuffix /$(test).c*,tests/* tests/unit/*))),$(UNIT))
MUTATED_TESTS := $(MUTATED_SOURCES:%=build/release/%.o)
BENCH := $(wildcard tests/bench/*.c)
BENCH_SUPPORT := tests/support/ls_problem.c tests/support/chain.c $(SIMULATOR)

# The same sources are built in several ways; objects of one way live in build/<way>/.
WAY_release := -O2
WAY_double := -O2 -DAUVID_REAL_DOUBLE
WAY_sanitized := -O1 -g1 -fno-omit-frame-pointer \
    -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all
WAY_bench := -O2 -DAUVID_MAX_POPULATION=130
# The program's sizes, and those of the tests of models that the default sizes have no room for:
# everything of the 6-DoF model free, and a known force beside its uncertain inputs.
WIDE := -DAUVID_MAX_PARAMETERS=32 -DAUVID_MAX_UNCERTAIN=146
WAY_wide := $(WAY_release) $(WIDE)
WAY_wide_double := $(WAY_double) $(WIDE)
WAY_wide_sanitized := $(WAY_sanitized) $(WIDE)
WAYS := release double sanitized bench wide wide_double wide_sanitized

# For everything but the tests.
CAREFUL := -Wfloat-equal -Wcast-qual -Wundef -Wswitch-enum
STRICT := -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wstrict-prototypes \
    $(CAREFUL)
FLAGS := -ffp-contract=off -MMD -MP -Ilib/include
# Everything but the library may use double and look at private headers.
FLAGS_tools := -std=c11 -Wall -Wextra -Wpedantic -Wshadow $(CAREFUL) -Ilib/src -Itools/simulator \
    -Iport/linux_socketcan
FLAGS_port := -std=c11 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes \
    $(CAREFUL)
FLAGS_tests := -Wall -Wextra -Ilib/src -Itools/simulator -Itools/auvid -Iport/linux_socketcan \
    -Itests/support -isystem $(UNITY_DIR) -DUNITY_INCLUDE_DOUBLE=

objects = $(patsubst %.c,build/$(1)/%.o,$(2))
TESTED = $(call objects,$(1),$(LIB) $(SIMULATOR) $(WORLD) $(SUPPORT)) build/$(1)/unity.o
# Under the sanitizers and in double these take a minute, and others run the same code: the long
# form only. The program itself is never built in double.
SLOW := $(addprefix %/tests/unit/,$(addprefix identifier/,test_adaptive \
    test_adaptive_benefit test_adaptive_checkpoint test_change_test \
    test_width) $(addprefix uncertain/,test_uncertain test_uncertain_rows \
    test_uncertain_causes))
SLOW_SANITIZED := $(SLOW) $(addprefix %/tests/unit/,$(addprefix tools/test_,doctor doctor_samples \
    doctor_sensors doctor_units doctor_campaign field field_mismatch field_run field_sensors \
    simulator simulator_sensors simulator_vehicle) \
    $(addprefix identifier/test_,drift identifier identifier_work identifier_work_model \
    identifier_work_sets prior prior_benefit prior_known \
    thrusters thrusters_identify thrusters_prior underactuated user_model) \
    uncertain/test_instruments uncertain/test_uncertain_checkpoint \
    uncertain/test_uncertain_estimate navigation/test_latency \
    can/test_can_accuracy excitation/test_excitation_plan search/test_optimizer_figures)
SLOW_DOUBLE := $(SLOW) $(addprefix %/tests/unit/,uncertain/test_uncertain_checkpoint \
    uncertain/test_uncertain_estimate \
    identifier/test_user_model) build/double/tests/unit/can/% build/double/tests/unit/checkpoint/%
unit_tests = $(UNIT:tests/unit/%.c=build/$(1)/tests/unit/%)
TEST_PROGRAMS := $(call unit_tests,release) \
    $(filter-out $(SLOW_SANITIZED),$(call unit_tests,sanitized)) \
    $(filter-out $(SLOW_DOUBLE) build/double/tests/unit/tools/%,$(call unit_tests,double)) \
    $(REFERENCE:%.cpp=build/release/%) \
    $(VEHICLES:%.c=build/wide/%) $(VEHICLES_REFERENCE:%.cpp=build/wide/%) \
    $(foreach way,release sanitized,$(PORT_TESTS:%.c=build/$(way)/%)) $(GOLDEN_TESTS)
# The larger models in double and under the sanitizers are left to the long form.
TEST_PROGRAMS_LONG := $(sort $(TEST_PROGRAMS) $(foreach way,sanitized double,\
    $(call unit_tests,$(way)))) \
    $(foreach way,wide_double wide_sanitized,$(VEHICLES:%.c=build/$(way)/%)) \
    $(VEHICLES_REFERENCE:%.cpp=build/wide_double/%)
# The CAN codec alone, for the comparison with cantools.
CAN_CODEC := $(wildcard lib/src/can/auvid_can*.c) lib/src/base/auvid_math.c
CAN_LIBRARIES := build/can/float.so build/can/double.so
CAN_CODEGEN := third_party/venv/bin/python tools/can_codegen/can_codegen.py
FUZZ := $(wildcard tests/fuzz/fuzz_*.c)
FUZZ_SECONDS ?= 60
# What tests/vcan runs on a real bus; no test by itself.
VCAN_PROGRAMS := $(patsubst %.c,build/release/%,$(wildcard tests/vcan/*.c))
BENCH_PROGRAMS := $(BENCH:%.c=build/bench/%)
# What Python looks at, with the debugging information from which it learns names and layouts.
VALIDATION := $(LIB) $(SIMULATOR) $(SUPPORT_FIRMWARE)
VALIDATION_LIBRARIES := $(addprefix build/validation/,float.so double.so large.so wide.so)
# large: double, populations as the literature has them, 25 n for n = 10, and models of other sizes.
VALIDATION_double := -DAUVID_REAL_DOUBLE
VALIDATION_large := -DAUVID_REAL_DOUBLE -DAUVID_MAX_POPULATION=250 -DAUVID_MAX_PARAMETERS=32
# wide: single precision, as on board, and the same models.
VALIDATION_wide := -DAUVID_MAX_PARAMETERS=32

# The same images for a board at other levels of optimization, and the host's.
images = $(foreach board,$(1),$(patsubst %,build/firmware/$(board)-Os/%.elf,\
    example $(FIRMWARE_PASSIVE)))
IMAGES := $(call images,$(BOARDS))
IMAGES_SHORT := $(call images,$(shell $(BOARD) short))
IMAGES_LONG := $(BOARDS:%=build/firmware/%-O2/example.elf)
# Unit tests there: see tests/firmware/unit.txt. At the levels of other images, whose objects are
# compiled for these anyway.
UNIT_BOARDS := m4f-O2 m0plus-Os
unit_listed = $(addprefix %/,$(shell awk '$$2 ~ /$(1)/ { print $$1 ".c" }' tests/firmware/unit.txt))
UNIT_IMAGES_LONG := $(foreach board,$(UNIT_BOARDS),\
    $(patsubst %.c,build/firmware/$(board)/%.elf,$(filter-out $(call unit_listed,host),$(UNIT))))
# Images whose instructions are counted, BOARD-LEVEL each. m3_20k is m3, with other sizes.
COUNTED := m4f-O2 $(patsubst %,%-Os,$(filter-out m3_20k,$(BOARDS)))
counted_images = $(foreach name,$(1),$(addprefix build/firmware/$(name)/,counted.elf rows.elf))
COUNTED_SHORT := build/firmware/count_plugin.so $(call counted_images,m4f-O2 m4f-Os) \
    $(foreach level,O2 Os,build/firmware/m4f-$(level)/tests/unit/identifier/test_hostile_inputs.elf)
COUNTED_IMAGES := $(COUNTED_SHORT) $(call counted_images,$(filter-out m4f-%,$(COUNTED)))
UNIT_IMAGES := $(filter-out $(patsubst %.c,%.elf,$(call unit_listed,long)),\
    $(filter build/firmware/m4f-O2/%,$(UNIT_IMAGES_LONG)))
# The example with port/cortex_m/optional/soft_float.c, and that with link-time optimization.
SOFT_FLOAT := port/cortex_m/optional/soft_float.c
SOFT_FLOAT_IMAGES := $(addprefix build/firmware/m0plus-Os/,soft_float.elf soft_float_lto.elf)
GOLDEN_IMAGE := build/firmware/m4f-O2/tests/golden/test_core.elf
# Its bytes are compared, see tests/firmware/test_checkpoint.sh; as a unit test it is left to the
# long form.
CHECKPOINT_IMAGES := $(foreach board,$(UNIT_BOARDS),\
    build/firmware/$(board)/tests/unit/checkpoint/test_checkpoint.elf)
FIRMWARE_FLAGS := -std=c11 $(FLAGS) -ffunction-sections -fdata-sections -fcallgraph-info=su
FIRMWARE_HOSTS := $(addprefix build/firmware/host/,gcc-O0 gcc-O3 clang-O2-ours gcc-O0-ours-20k)
# The other pairs of a compiler and its flags are left to the long form. gcc-O2-ours is what the
# program is built with, whose run all are compared with.
FIRMWARE_HOSTS_LONG := $(FIRMWARE_HOSTS) $(addprefix build/firmware/host/,gcc-O2 clang-O2 \
    gcc-O0-ours gcc-O2-ours gcc-O3-ours)

# Tests install what they need before anything is compiled; a plain build needs no more than gcc.
SETUP := $(if $(filter test test-long test-firmware,$(MAKECMDGOALS)),setup)

all: build/auvid ## Build the program, build/auvid (default)

help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "%-10s %s\n", $$1, $$2 }' Makefile

demo: build/auvid ## Build the program and identify a simulated vehicle with it
	build/auvid demo

test: build/auvid $(TEST_PROGRAMS) | setup ## Install what is missing, run all tests (minutes)
	@tests/run.sh $(VCAN_SHORT) $(FIRMWARE_SCRIPTS) $(VALIDATION_SHORT) \
	    $(filter-out $(BUILDS),$(SCRIPTS)) $(TEST_PROGRAMS) -- tests/statuses/test_statuses.sh

test-long: build/auvid $(TEST_PROGRAMS_LONG) | setup ## The same with long campaigns (hours)
	@AUVID_TEST_LONG=1 tests/run.sh $(VCAN_SCRIPTS) $(FIRMWARE_SCRIPTS) \
	    $(SCRIPTS) $(TEST_PROGRAMS_LONG) $(VALIDATION_SCRIPTS) $(MUTATION_SCRIPTS) -- \
	    tests/statuses/test_statuses.sh

test test-long: $(CAN_LIBRARIES) $(VCAN_PROGRAMS)
test test-long: $(filter-out %/large.so %/wide.so,$(VALIDATION_LIBRARIES))
test-long: $(VALIDATION_LIBRARIES) $(BENCH_PROGRAMS) # these are only built
test test-long test-firmware: $(IMAGES_SHORT) $(UNIT_IMAGES) $(FIRMWARE_HOSTS) $(COUNTED_SHORT)
test test-long test-firmware: $(GOLDEN_IMAGE) $(CHECKPOINT_IMAGES) $(SOFT_FLOAT_IMAGES)
test-long: $(IMAGES) $(IMAGES_LONG) $(COUNTED_IMAGES) $(UNIT_IMAGES_LONG) $(FIRMWARE_HOSTS_LONG)

test-vcan: build/auvid $(VCAN_PROGRAMS) | setup ## Tests on real CAN, in a virtual machine if needed
	@tests/run.sh $(VCAN_SCRIPTS)

firmware: $(IMAGES) ## Build the examples for each microcontroller: build/firmware/*/*.elf

test-firmware: build/auvid | setup ## Run it in QEMU, with unit tests: the bits must be the host's
	@tests/run.sh $(FIRMWARE_SCRIPTS)

bench-firmware: build/auvid $(COUNTED_IMAGES) ## Exact instructions of each function, on each core
	@tests/firmware/bench.sh build/firmware/instructions.csv

bench-eigen: build/firmware/count_plugin.so | firmware-setup ## The navigation step beside Eigen's
	@tests/support/setup.sh eigen
	@tests/firmware/bench_eigen.sh

lint: ## Install what is missing and check the coding rules
	@tests/lint/lint.sh

size: $(IMAGES) ## Firmware's flash, RAM and stack against a baseline (SIZE=write: write it)
	@tests/firmware/size.py $(BOARDS) >build/firmware/size.csv
	@$(if $(filter write,$(SIZE)),cp build/firmware/size.csv tests/firmware/size.csv && \
	    tests/firmware/size.py --readme write && tests/firmware/size.py --rooms write,\
	    tests/firmware/baseline.py tests/firmware/size.csv build/firmware/size.csv)

mutate: $(MUTATION_OBJECTS) $(MUTATED_TESTS) | mutate-setup ## Change FILE: does a unit test fail?
	@third_party/mutation/bin/python tests/mutation/mutate.py $(FILE) $(LINES:%=--lines %) \
	    $(if $(LINES)$(TESTS),--part) --objects $(MUTATION_OBJECTS) --tests $(MUTATED_TESTS) \
	    --compile '$(CC) -std=c11 $(WAY_release) $(FLAGS) $(CFLAGS)' \
	    --link '$(CXX) $(LDFLAGS)' --sanitize='$(WAY_sanitized)'

mutate-setup: ## Install what `make mutate` needs (python3-venv, tree-sitter in a venv)
	@tests/support/setup.sh mutate

bench: $(BENCH_PROGRAMS) ## Build and run the benchmarks
	@for program in $^; do $$program || exit 1; done

can: | can-setup ## Generate the C of the CAN frames from lib/can/auvid.dbc
	@$(CAN_CODEGEN)

can-check: | can-setup ## Check that the C of the CAN frames matches lib/can/auvid.dbc
	@$(CAN_CODEGEN) --check

fuzz: ## Fuzz CAN receivers and vehicle files for FUZZ_SECONDS (60)
	@tests/support/setup.sh fuzz
	@CFLAGS='$(FLAGS)' tests/fuzz/fuzz.sh $(FUZZ_SECONDS) $(FUZZ)

setup: ## Install what the tests need (apt-get, pip); fetch Unity and a kernel with CAN
	@tests/support/setup.sh test can firmware validate python
	@tests/support/setup.sh vcan || echo "tests on real CAN will be skipped"

firmware-setup: | $(SETUP) ## Install the cross compilers and QEMU
	@tests/support/setup.sh firmware

can-setup: ## Install what `make can` needs (python3-venv, cantools in third_party/venv)
	@tests/support/setup.sh can

validate: build/auvid $(VALIDATION_LIBRARIES) | validate-setup ## Compare with references (Python)
	@third_party/validation/bin/auvid-validate references

validate-setup: ## Install what `make validate` needs (python3-venv, third_party/validation)
	@tests/support/setup.sh validate

clean: ## Remove build/ (third_party/ stays)
	rm -rf build

.PHONY: all help demo test test-long lint size bench setup clean
.PHONY: validate validate-setup
.PHONY: can can-check can-setup fuzz test-vcan mutate mutate-setup
.PHONY: firmware firmware-setup test-firmware bench-firmware bench-eigen

build/auvid: $(call objects,wide,$(LIB) $(SIMULATOR) $(PROGRAM) $(PORT))
	@echo "  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ -lm

# $(1) is the way. A test program that does not build must not stop the others: tests/run.sh counts
# it as failed.
define rules
build/$(1)/lib/%.o: lib/%.c Makefile | $(SETUP)
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)$$(CC) -std=c11 $(WAY_$(1)) $$(FLAGS) $$(STRICT) $$(CFLAGS) -c -o $$@ $$<

build/$(1)/tools/%.o: tools/%.c Makefile | $(SETUP)
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)$$(CC) $(WAY_$(1)) $$(FLAGS) $$(FLAGS_tools) $$(CFLAGS) -c -o $$@ $$<

build/$(1)/port/%.o: port/%.c Makefile | $(SETUP)
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)$$(CC) $(WAY_$(1)) $$(FLAGS) $$(FLAGS_port) $$(CFLAGS) -c -o $$@ $$<

build/$(1)/tests/support/%.o: tests/support/%.c Makefile | $(SETUP)
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)$$(CC) -std=c11 $(WAY_$(1)) $$(FLAGS) $$(FLAGS_tests) $$(CFLAGS) -c -o $$@ $$<

build/$(1)/unity.o: Makefile | setup
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)$$(CC) -std=c11 -w $(WAY_$(1)) -DUNITY_INCLUDE_DOUBLE= -c -o $$@ $$(UNITY_DIR)/unity.c

# The linker takes from an archive only what a test calls.
build/$(1)/tested.a: $(call TESTED,$(1))
	@rm -f $$@; echo "  $$@"
	$$(Q)$(AR) qcs $$@ $$^

build/$(1)/tests/%: tests/%.cpp build/$(1)/tested.a
	@mkdir -p $$(@D); rm -f $$@; echo "  $$@"
	$$(Q)$$(EIGEN_CXX) -std=c++17 $(WAY_$(1)) -O1 $$(EIGEN_FLAGS) $$(FLAGS) $$(FLAGS_tests) \
	    -isystem $$(EIGEN_DIR) $$(CXXFLAGS) -MF $$@.d -MT $$@ -o $$@ $$< build/$(1)/tested.a -lm

build/$(1)/tests/port/%: tests/port/%.c tests/port/fake_system.c $(call objects,$(1),$(PORT))
	@mkdir -p $$(@D); rm -f $$@; echo "  $$@"
	$$(Q)$$(CC) -std=c11 $(WAY_$(1)) $$(FLAGS) -Wall -Wextra -Iport/linux_socketcan $$(CFLAGS) \
	    -MF $$@.d -MT $$@ -o $$@ $$< tests/port/fake_system.c $(call objects,$(1),$(PORT)) \
	    $$(WRAPPED) -lcmocka
endef
$(foreach way,$(WAYS),$(eval $(call rules,$(way))))

# $(1) is the way, $(2) the folder. Only what is tested need be fast.
define test_rules
build/$(1)/tests/$(2)/%: tests/$(2)/%.c build/$(1)/tested.a
	@mkdir -p $$(@D); rm -f $$@; echo "  $$@"
	$$(Q)$$(CC) -std=c11 $(WAY_$(1)) -O1 $$(FLAGS) $$(FLAGS_tests) $$(STATUSES) $$(CFLAGS) \
	    -MF $$@.d -MT $$@ -o $$@ $$< build/$(1)/tested.a -lm
endef
$(foreach way,$(WAYS),$(foreach folder,unit vehicles golden,\
    $(eval $(call test_rules,$(way),$(folder)))))

# The compiler reads Eigen once.
WITH_EIGEN := $(shell grep -lE 'include (<Eigen/|"bound.h"|"[a-z]*_reference.h")' \
    $(REFERENCE) $(VEHICLES_REFERENCE))
WITH_EIGEN := $(foreach way,$(WAYS),$(WITH_EIGEN:%.cpp=build/$(way)/%))
$(WITH_EIGEN): EIGEN_FLAGS = -include build/eigen.h
$(WITH_EIGEN): build/eigen.h.gch
build/eigen.h.gch: tests/reference/eigen.h Makefile | setup
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(EIGEN_CXX) -std=c++17 -O1 $(filter-out -MMD -MP,$(FLAGS)) -isystem $(EIGEN_DIR) \
	    $(CXXFLAGS) -x c++-header -o $@ $<

$(RECORDED): STATUSES = -I. -include build/statuses/record.h -DSTATUSES_FILE='"$@.statuses"'
$(RECORDED): build/statuses/record.h
build/statuses/record.h: tests/statuses/statuses.py $(PUBLIC) | $(SETUP)
	@mkdir -p $(@D); echo "  $@"
	$(Q)tests/statuses/statuses.py record >$@

build/release/tests/vcan/%: tests/vcan/%.c $(call objects,release,$(PORT))
	@mkdir -p $(@D); rm -f $@; echo "  $@"
	$(Q)$(CC) -std=c11 -O2 $(FLAGS) -Wall -Wextra -Iport/linux_socketcan $(CFLAGS) \
	    -MF $@.d -MT $@ -o $@ $< $(call objects,release,$(PORT))

build/release/tests/%.c.o: tests/%.c Makefile | setup
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(CC) -std=c11 $(WAY_release) $(FLAGS) $(FLAGS_tests) $(CFLAGS) -MF $@.d -c -o $@ $<

build/release/tests/%.cpp.o: tests/%.cpp Makefile | setup
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(CXX) -std=c++17 $(WAY_release) $(FLAGS) $(FLAGS_tests) -isystem $(EIGEN_DIR) \
	    $(CXXFLAGS) -MF $@.d -c -o $@ $<

build/bench/tests/bench/%: tests/bench/%.c $(call objects,bench,$(LIB) $(BENCH_SUPPORT))
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(CC) -std=c11 $(WAY_bench) $(FLAGS) -Ilib/src -Itests/support -Itools/simulator \
	    $(CFLAGS) -MF $@.d -MT $@ -o $@ $< $(call objects,bench,$(LIB) $(BENCH_SUPPORT)) -lm

# Unity 2.4.3 takes a machine of 32 bits for one without integers of 64.
UNITY_64 := -DUNITY_SUPPORT_64 -DUNITY_INCLUDE_DOUBLE=

# $(1) is the board, $(2) the level of optimization.
define firmware_rules
build/firmware/$(1)-$(2)/%.o: %.c Makefile port/cortex_m/boards.txt | firmware-setup
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)`$(BOARD) $(1) compile` -$(2) $$(FIRMWARE_FLAGS) -Iport/cortex_m -c -o $$@ $$< \
	    $$(if $$(filter lib/% port/%,$$<),$(STRICT) -Werror,$(FLAGS_tools) -Itests/support)

build/firmware/$(1)-$(2)/example.elf: port/cortex_m/firmware.ld \
        $(patsubst %.c,build/firmware/$(1)-$(2)/%.o,$(LIB) $(FIRMWARE_START) $(FIRMWARE_EXAMPLE))
	@echo "  $$@"
	$$(Q)`$(BOARD) $(1) link` -Wl,-Map=$$(@:.elf=.map) -o $$@ $$(filter %.o,$$^)

$(FIRMWARE_PASSIVE:%=build/firmware/$(1)-$(2)/%.elf): build/firmware/$(1)-$(2)/%.elf: \
        port/cortex_m/firmware.ld $(patsubst %.c,build/firmware/$(1)-$(2)/%.o,\
        $(LIB) $(FIRMWARE_START) port/cortex_m/passive/driver_qemu.c) \
        build/firmware/$(1)-$(2)/port/cortex_m/passive/%.o
	@echo "  $$@"
	$$(Q)`$(BOARD) $(1) link` -Wl,-Map=$$(@:.elf=.map) -o $$@ $$(filter %.o,$$^)

build/firmware/$(1)-$(2)/unity.o: Makefile | setup
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)`$(BOARD) $(1) compile` -$(2) -std=c11 -w $(UNITY_64) -c -o $$@ $$(UNITY_DIR)/unity.c

build/firmware/$(1)-$(2)/tests/%.elf: tests/%.c build/firmware/$(1)-$(2)/unity.o \
        $(patsubst %.c,build/firmware/$(1)-$(2)/%.o,\
        $(LIB) $(SIMULATOR) $(SUPPORT_FIRMWARE) $(FIRMWARE_START))
	@mkdir -p $$(@D); echo "  $$@"
	$$(Q)`$(BOARD) $(1) link` -O1 $$(FIRMWARE_FLAGS) $$(FLAGS_tests) $(UNITY_64) \
	    --specs=rdimon.specs -Wl,--defsym=STACK_SIZE=0x80000 -MF $$@.d -MT $$@ \
	    -o $$@ $$(filter %.c %.o,$$^) -lm

# What instructions are counted of: see tests/firmware/bench.sh.
build/firmware/$(1)-$(2)/counted.elf: build/firmware/$(1)-$(2)/example.elf \
        build/firmware/$(1)-$(2)/tests/firmware/machine_calm.o
	@echo "  $$@"
	$$(Q)`$(BOARD) $(1) link` -Wl,--wrap=machine_timer,--wrap=machine_sleep -o $$@ \
	    $(patsubst %.c,build/firmware/$(1)-$(2)/%.o,\
	    $(LIB) $(FIRMWARE_START) $(FIRMWARE_EXAMPLE)) $$(filter %.o,$$^)

build/firmware/$(1)-$(2)/rows.elf: $(patsubst %.c,build/firmware/$(1)-$(2)/%.o,\
        $(LIB) $(FIRMWARE_START) tests/firmware/bench_rows.c)
	@echo "  $$@"
	$$(Q)`$(BOARD) $(1) link` -o $$@ $$^
endef
$(foreach board,$(BOARDS),$(foreach level,Os O2,$(eval $(call firmware_rules,$(board),$(level)))))

build/firmware/m0plus-Os/soft_float.elf: port/cortex_m/firmware.ld \
        $(patsubst %.c,build/firmware/m0plus-Os/%.o,\
        $(LIB) $(FIRMWARE_START) $(FIRMWARE_EXAMPLE) $(SOFT_FLOAT))
	@echo "  $@"
	$(Q)`$(BOARD) m0plus link` -Wl,-Map=$(@:.elf=.map) -o $@ $(filter %.o,$^)

build/firmware/m0plus-Os/soft_float_lto.elf: port/cortex_m/firmware.ld \
        $(LIB) $(FIRMWARE_START) $(FIRMWARE_EXAMPLE) $(SOFT_FLOAT) \
        $(PUBLIC) $(wildcard lib/src/*/*.h port/cortex_m/*.h) Makefile | firmware-setup
	@mkdir -p $(@D); echo "  $@"
	$(Q)`$(BOARD) m0plus link` -Os -flto=auto -std=c11 -ffp-contract=off -ffunction-sections \
	    -Ilib/include -Iport/cortex_m -Wl,-Map=$(@:.elf=.map) -o $@ $(filter %.c,$^)

build/firmware/count_plugin.so: tests/firmware/count_plugin.c
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(CC) -std=gnu11 -O2 -Wall -Wextra -shared -fPIC $(CFLAGS) -o $@ $<

# The library as one translation unit, compiled in half of the time: see tests/lint/unity.sh.
INCLUDE_LIBRARY = printf '\#include "%s"\n' $(LIB)
WHOLE_LIBRARY := -xc - -xnone

# The example on the host: with nothing but a level of optimization, which leaves the compiler free
# to use whatever this machine has, and with our flags ("-ours").
build/firmware/host/%: $(LIB) $(FIRMWARE_EXAMPLE) tests/firmware/machine_host.c \
        $(PUBLIC) $(wildcard lib/src/*/*.h port/cortex_m/*.h port/cortex_m/*/*.h) \
        | firmware-setup
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(INCLUDE_LIBRARY) | $(word 1,$(subst -, ,$*)) -$(word 2,$(subst -, ,$*)) \
	    $(if $(findstring ours,$*),-std=c11 -ffp-contract=off,-march=native) \
	    $(if $(findstring 20k,$*),'-DAUVID_USER_CONFIG="example/config_20k.h"') \
	    -Ilib/include -Iport/cortex_m -I. -o $@ $(WHOLE_LIBRARY) \
	    $(FIRMWARE_EXAMPLE) tests/firmware/machine_host.c

build/can/%.so: $(CAN_CODEC) $(PUBLIC) $(wildcard lib/src/*/*.h) Makefile | $(SETUP)
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(CC) -std=c11 -O2 -fPIC -shared $(if $(findstring double,$*),-DAUVID_REAL_DOUBLE) \
	    -ffp-contract=off -Ilib/include $(CFLAGS) -o $@ $(CAN_CODEC)

build/validation/%.so: $(VALIDATION) Makefile \
        $(PUBLIC) $(wildcard lib/src/*/*.h tools/simulator/*.h tests/support/*.h) | $(SETUP)
	@mkdir -p $(@D); echo "  $@"
	$(Q)$(INCLUDE_LIBRARY) | $(CC) -std=c11 -O1 -g -fno-var-tracking -fPIC -shared \
	    $(VALIDATION_$*) -ffp-contract=off -Ilib/include -Ilib/src -Itools/simulator \
	    -Itests/support -I. $(CFLAGS) -o $@ $(WHOLE_LIBRARY) \
	    $(filter-out $(LIB),$(VALIDATION)) -lm

.IGNORE: build/eigen.h.gch $(TEST_PROGRAMS_LONG) $(VCAN_PROGRAMS) $(VALIDATION_LIBRARIES)
.IGNORE: $(IMAGES) $(IMAGES_LONG) $(UNIT_IMAGES_LONG) $(FIRMWARE_HOSTS_LONG) $(COUNTED_IMAGES)
.IGNORE: $(GOLDEN_IMAGE) $(CHECKPOINT_IMAGES)

-include $(foreach way,$(WAYS),$(patsubst %.o,%.d,\
    $(call objects,$(way),$(LIB) $(SIMULATOR) $(PROGRAM) $(PORT) $(SUPPORT))))
-include $(wildcard build/firmware/*/*/*/*.d build/firmware/*/*/*/*/*.d)
-include $(addsuffix .d,$(TEST_PROGRAMS_LONG) $(VCAN_PROGRAMS) $(BENCH_PROGRAMS) $(MUTATED_TESTS))
