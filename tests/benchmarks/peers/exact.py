"""The exact rates of success of the walk, by the probabilities of all places after each step.

Prints the mean number of steps in a trial, over all levels of noise, and the rate at each.
"""

SIDE, LIMIT, NOISES = 12, 40, [0, 0.1, 0.2, 0.4, 0.6]
HEADINGS = [(1, 0), (0, 1), (-1, 0), (0, -1)]
GOAL = (SIDE - 1, SIDE - 1)


def go(place, heading):
    """Return the place one cell further, or PLACE if there is a wall."""
    x, y = place[0] + heading[0], place[1] + heading[1]
    return (x, y) if 0 <= x < SIDE and 0 <= y < SIDE else place


def step(places, noise):
    """Return the probabilities of all places a step after the probabilities PLACES."""
    after = dict.fromkeys(places, 0.0)
    for place, probability in places.items():
        towards = 0 if place[0] <= place[1] else 1
        for index, heading in enumerate(HEADINGS):
            share = noise / 4 + (1 - noise) * (index == towards)
            after[place if place == GOAL else go(place, heading)] += probability * share
    return after


def walk(noise):
    """Return the probability of being at the goal within LIMIT steps, and the mean of steps."""
    places = {(x, y): 0.0 for x in range(SIDE) for y in range(SIDE)}
    places[0, 0] = 1.0
    steps = 0.0
    for _ in range(LIMIT):
        steps += 1 - places[GOAL]
        places = step(places, noise)
    return places[GOAL], steps


walks = [walk(noise) for noise in NOISES]
print("exact", sum(steps for _, steps in walks) / len(walks), *(f"{rate:.3f}" for rate, _ in walks),
      sep="|")
