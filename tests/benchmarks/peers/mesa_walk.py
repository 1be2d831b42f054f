"""The walk across a room in Mesa: an agent on a grid, its model run by batch_run.

Lines are counted by ./run under the names after "# ==", as in trials.py.
"""

# == measuring
import sys
import time

# == CSV
import pandas

# == question
from mesa import DataCollector, Model
from mesa.batchrunner import batch_run
from mesa.discrete_space import CellAgent, OrthogonalVonNeumannGrid

# == intervals
from scipy.stats import binomtest

# == question
SIDE = 12
NOISES = [0, 0.1, 0.2, 0.4, 0.6]
SEEDS = range(1, 1001)
LIMIT = 40
HEADINGS = [(1, 0), (0, 1), (-1, 0), (0, -1)]


class Walker(CellAgent):
    """An agent that heads for the far corner, but for NOISE."""

    def choose(self):
        """Return the index of the next step's heading: towards the goal, or at random."""
        if self.random.random() < self.model.noise:
            return self.random.randrange(4)
        x, y = self.cell.coordinate
        return 0 if x <= y else 1

    def step(self):
        """Go to the next cell, unless there is a wall."""
        ahead = self.cell.connections.get(HEADINGS[self.choose()])
        if ahead is not None:
            self.move_to(ahead)


class Room(Model):
    """A room with a walker in it."""

    def __init__(self, noise, seed):
        super().__init__(seed=seed)
        self.noise = noise
        self.grid = OrthogonalVonNeumannGrid((SIDE, SIDE), random=self.random)
        self.walker = Walker(self)
        self.walker.cell = self.grid[(0, 0)]
        self.datacollector = DataCollector({"success": Room.success, "steps": "steps"})

    def success(self):
        """True if the walker is in the goal's cell."""
        return self.walker.cell.coordinate == (SIDE - 1, SIDE - 1)

    def step(self):
        """Let the walker take a step."""
        self.walker.step()
        self.datacollector.collect(self)
        self.running = not self.success()


def run(cores):
    """Return the rows of all trials, once the last is done."""
    return batch_run(
        Room,
        {"noise": NOISES, "seed": SEEDS},
        max_steps=LIMIT - 1,  # batch_run goes one step further
        display_progress=False,
        # == 2 cores
        number_processes=cores,
        # == question
    )


# == CSV
def save(path, rows):
    """Write ROWS into the file PATH."""
    pandas.DataFrame(rows).to_csv(path, index=False)


# == intervals
def intervals(path):
    """Return a dictionary from noises to rate, low and high, of the rows in the file PATH."""
    table = {}
    for noise, won in pandas.read_csv(path).groupby("noise")["success"]:
        low, high = binomtest(int(won.sum()), len(won)).proportion_ci(method="wilson")
        table[noise] = (won.mean(), low, high)
    return table


# == measuring
def main(cores, path):
    """Do all trials on CORES cores, with rows in the file PATH. Print the figures ./run wants."""
    start = time.perf_counter()
    save(path, run(cores))
    seconds = time.perf_counter() - start
    rates = [row[0] for row in intervals(path).values()]
    print("Mesa", cores, f"{seconds:.3f}", *rates, sep="|")


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
