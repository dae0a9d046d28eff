"""Says what will run and how long it takes, from `rodwake check`, before anything runs."""


def tell(lab, runs):
    if not runs:
        print("every run is done", flush=True)
        return
    beds = [run for run in runs if "[granular]" in lab.scene(run).read_text(encoding="utf-8")]
    print(f"{len(runs)} runs to make, {len(runs) - len(beds)} of the theory, some seconds each with their figures; asking rodwake check what\n"
          f"the {len(beds)} beds cost ...", flush=True)
    costs = {run.name: lab.cost(run) for run in beds}
    for name, seconds in costs.items():
        print(f"  {name:24} {'?' if seconds is None else in_words(seconds)}", flush=True)
    total = sum(seconds or 0.0 for seconds in costs.values())
    print(f"at most {in_words(total)} of CPU, {in_words(total / lab.threads)} on {lab.threads} threads, figures not counted: pairs stop when\n"
          "they have gone half a box. Ctrl-C stops; the same command goes on.", flush=True)


def in_words(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
