"""Long runs: ``python -m fuzz [FIRST:]LAST [FORMAT ...]``, with ``tests`` on the path, prints faults and figures."""

import sys
import time

from fuzz.runner import fault, worker
from fuzz.samples import SAMPLES


def say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main() -> int:
    first, _, last = sys.argv[1].rpartition(":")
    names = sys.argv[2:] or list(SAMPLES)
    failed = 0
    with worker() as made:
        for name in names:
            began, faults, accepted, slowest, largest = time.perf_counter(), {}, 0, 0.0, 0
            start = int(first or 0)
            seeds = range(start, start + round((int(last) - start) * SAMPLES[name].share))
            for seed in seeds:
                result = made.case(name, seed)
                found = fault(result)
                if found is not None:
                    faults.setdefault(found.strip().splitlines()[-1][:150], []).append((seed, found))
                accepted += result.get("code") == 0
                slowest, largest = max(slowest, result.get("seconds", 0.0)), max(largest, result.get("bytes", 0))
            for told, cases in faults.items():
                say(f"--- {name}: {len(cases)} x {told}\n    seeds {[seed for seed, _ in cases][:5]}\n{cases[0][1]}")
            count = sum(map(len, faults.values()))
            failed += count
            say(
                f"{name}: {len(seeds)} cases, {accepted} accepted, {count} faults, slowest "
                f"{slowest:.1f} s, most {largest / 1e6:.0f} MB, in {time.perf_counter() - began:.0f} s"
            )
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
