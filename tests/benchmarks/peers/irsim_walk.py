"""The walk across a room in ir-sim: a robot with two wheels that turns, then drives a metre."""

# == question
import math
import random
from pathlib import Path

import irsim

import trials

SIDE = 12
ROOM = Path(__file__).with_name("irsim_room.yaml")
env = irsim.make(str(ROOM), headless=True, log_level="WARNING")


def cell():
    """Return the column and the row of the cell that the robot is in."""
    return int(env.robot.state[0, 0]), int(env.robot.state[1, 0])


def choose(noise, dice):
    """Return the heading of the next step, in quarter circles: towards the goal, or at random."""
    if dice.random() < noise:
        return dice.randrange(4)
    x, y = cell()
    return 0 if x <= y else 1


def wall_ahead(heading):
    """True if the next cell that way is a wall."""
    x, y = cell()
    dx, dy = [(1, 0), (0, 1), (-1, 0), (0, -1)][heading]
    return not (1 <= x + dx <= SIDE and 1 <= y + dy <= SIDE)


def turn_to(heading):
    """Turn the robot to HEADING."""
    turn = math.remainder(heading * math.pi / 2 - env.robot.state[2, 0], 2 * math.pi)
    if abs(turn) > 1e-6:
        env.step([0, turn])


def trial(task):
    """Do the trial TASK, a noise and a seed; return its row."""
    noise, seed = task
    dice = random.Random(seed)
    env.reset()
    for step in range(1, trials.LIMIT + 1):
        heading = choose(noise, dice)
        turn_to(heading)
        if not wall_ahead(heading):
            env.step([1, 0])
        if cell() == (SIDE, SIDE):
            return noise, seed, True, step
    return noise, seed, False, trials.LIMIT


# == measuring
if __name__ == "__main__":
    trials.main("ir-sim", trial)
