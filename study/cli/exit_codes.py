"""Exit codes of the command line; 0 is a good end."""

#: An analysis has results that are not certified, or wear stopped before its time.
EXIT_UNCERTIFIED = 1
#: A mistake in what was asked for; one message says which.
EXIT_MISTAKE = 2
