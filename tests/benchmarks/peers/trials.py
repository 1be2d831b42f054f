"""What a user writes around a simulator that runs an episode but no experiment.

Lines are counted by ./run under the names after "# ==", up to the next; what is only for ./run
stands under "measuring". The question itself is in minigrid_walk.py and irsim_walk.py.
"""

# == CSV
import csv
import os

# == measuring
import sys
import time

# == 2 cores
from multiprocessing import Pool

# == intervals
from scipy.stats import binomtest

# == question
NOISES = [0, 0.1, 0.2, 0.4, 0.6]
SEEDS = range(1, 1001)
LIMIT = 40


# == CSV
def append(path, rows):
    """Append ROWS to the file PATH, each as it comes."""
    fresh = not os.path.exists(path)
    with open(path, "a", newline="") as file:
        writer = csv.writer(file)
        if fresh:
            writer.writerow(["noise", "seed", "success", "steps"])
        for row in rows:
            writer.writerow(row)
            file.flush()


def read(path):
    """Return the rows of the file PATH, as dictionaries."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


# == resume
def missing(path):
    """Return the trials, each a noise and a seed, that have no row in the file PATH."""
    rows = read(path) if os.path.exists(path) else []
    done = {(float(row["noise"]), int(row["seed"])) for row in rows}
    return [(noise, seed) for noise in NOISES for seed in SEEDS if (noise, seed) not in done]


# == 2 cores
def results(trial, todo, cores):
    """Return the rows of the trials TODO, in that order, from CORES processes."""
    if cores == 1:
        yield from map(trial, todo)
    else:
        with Pool(cores) as pool:
            yield from pool.imap(trial, todo, chunksize=50)


# == intervals
def intervals(path):
    """Return a dictionary from noises to rate, low and high, of the rows in the file PATH."""
    table, rows = {}, read(path)
    for noise in NOISES:
        won = [row["success"] == "True" for row in rows if float(row["noise"]) == noise]
        low, high = binomtest(sum(won), len(won)).proportion_ci(method="wilson")
        table[noise] = (sum(won) / len(won), low, high)
    return table


# == measuring
def main(name, trial):
    """Do all trials by the function TRIAL, as the command line says: CORES FILE. Print the figures
    that ./run wants."""
    cores, path = int(sys.argv[1]), sys.argv[2]
    start = time.perf_counter()
    append(path, results(trial, missing(path), cores))
    seconds = time.perf_counter() - start
    rates = [row[0] for row in intervals(path).values()]
    print(name, cores, f"{seconds:.3f}", *rates, sep="|")
