"""Exit codes of the command line; 0 is success."""

#: The result holds uncertified values, the wear ended early, a verification is outside its limits, or a designed member
#: has no whole tooth.
EXIT_UNCERTIFIED = 1
#: The user's mistake; one message says which.
EXIT_MISTAKE = 2
