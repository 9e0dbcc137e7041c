"""Notes on a result: implausible numbers, load on edges, pressures that jump, ranges of the friction models left."""
