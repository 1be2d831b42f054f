"""The walk across a room in MiniGrid: a robot that turns and goes forward by actions."""

# == question
import random

from minigrid.envs.empty import EmptyEnv

import trials

SIDE = 12
env = EmptyEnv(size=SIDE + 2, max_steps=1_000_000)


def choose(noise, dice):
    """Return the heading of the next step, in quarter circles: towards the goal, or at random."""
    if dice.random() < noise:
        return dice.randrange(4)
    x, y = env.agent_pos
    return 0 if x <= y else 1


def turn_to(heading):
    """Turn the robot to HEADING."""
    while env.agent_dir != heading:
        left = (env.agent_dir - heading) % 4 == 1
        env.step(env.actions.left if left else env.actions.right)


def trial(task):
    """Do the trial TASK, a noise and a seed; return its row."""
    noise, seed = task
    dice = random.Random(seed)
    env.reset(seed=seed)
    for step in range(1, trials.LIMIT + 1):
        turn_to(choose(noise, dice))
        observation, reward, at_goal, truncated, info = env.step(env.actions.forward)
        if at_goal:
            return noise, seed, True, step
    return noise, seed, False, trials.LIMIT


# == measuring
if __name__ == "__main__":
    trials.main("MiniGrid", trial)
