"""The parameter study of the film model, and the friction formula fitted to it."""
