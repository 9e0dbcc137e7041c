"""Notes on a result: implausible numbers, supports, line ends, edges, pressures that jump, ranges of models left."""
