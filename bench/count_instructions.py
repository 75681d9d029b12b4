#!/usr/bin/env python3
"""Instructions and floating-point operations per element-step of the shells, counted by callgrind.

Needs valgrind and binutils, and a build without AVX-512, which valgrind does not know:

    cmake -S . -B build/count -G Ninja -DTUFT_NATIVE=OFF -DTUFT_BUILD_TESTS=OFF -DCMAKE_BUILD_TYPE=Release \\
          -DCMAKE_CXX_FLAGS="-mavx2 -mfma"
    cmake --build build/count --target shell_step
    bench/count_instructions.py build/count/bin/shell_step

Counts are those of two runs of different length subtracted, so that setting up drops out. A fused multiply-add is
two operations; a packed one as many as it has lanes.
"""
import re
import subprocess
import sys
import tempfile

LANES = {"xmm": 2, "ymm": 4, "zmm": 8}
ARITHMETIC = re.compile(r"^v(add|sub|mul|div|sqrt|max|min|addsub|hadd)(p|s)d$")
FUSED = re.compile(r"^vfn?m(add|sub)\d+(p|s)d$")
SLOW = re.compile(r"^v(div|sqrt)(p|s)d$")


def disassembly(program):
    """Mnemonic and operands of each address."""
    table = {}
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", program], capture_output=True, text=True, check=True).stdout
    for line in text.splitlines():
        match = re.match(r"\s*([0-9a-f]+):\s+(\S+)\s*(.*)", line)
        if match:
            table[int(match[1], 16)] = (match[2], match[3])
    return table


def operations(mnemonic, operands):
    """Floating-point operations of an instruction, and those that are divisions and roots."""
    fused = FUSED.match(mnemonic)
    if not fused and not ARITHMETIC.match(mnemonic):
        return 0, 0
    register = re.search(r"[xyz]mm", operands)
    lanes = LANES[register[0]] if register and mnemonic.endswith("pd") else 1
    return (2 if fused else 1) * lanes, lanes if SLOW.match(mnemonic) else 0


def run(program, case, steps):
    """Executions by address inside the program, and element-steps."""
    with tempfile.NamedTemporaryFile() as out:
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", "--dump-instr=yes", "--compress-pos=no", "--compress-strings=no",
             f"--callgrind-out-file={out.name}", program, str(case), str(steps)],
            capture_output=True, text=True, check=True)
        counts, ours, skip = {}, False, False
        for line in open(out.name, encoding="utf-8"):
            if line.startswith("ob="):
                ours = line.strip().endswith("shell_step")
            elif line.startswith("calls="):
                skip = True  # the next line is the cost of what was called
            elif line.startswith("0x"):
                fields = line.split()
                if ours and not skip:
                    address = int(fields[0], 16)
                    counts[address] = counts.get(address, 0) + int(fields[2])
                skip = False
    name, element_steps = done.stdout.split()
    return name, int(element_steps), counts


def main():
    program = sys.argv[1]
    table = disassembly(program)
    base = min(table)
    print("case | instructions | operations | of these divisions and roots (per element-step)")
    for case in range(5):
        name, few, short = run(program, case, 2)
        _, many, long = run(program, case, 6)
        instructions = flops = slow = 0
        for address, count in long.items():
            own = count - short.get(address, 0)
            instructions += own
            # Position-independent programs are loaded at an address of valgrind's choosing.
            entry = table.get(address) or table.get(address - LOAD_ADDRESS)
            if entry:
                f, s = operations(*entry)
                flops += own * f
                slow += own * s
        steps = many - few
        print(f"{name} | {instructions / steps:.0f} | {flops / steps:.0f} | {slow / steps:.1f}")


LOAD_ADDRESS = 0x108000  # of valgrind's loader for position-independent programs on x86-64, less the first page

if __name__ == "__main__":
    main()
