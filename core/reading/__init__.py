"""Reading of files that may be damaged or hostile: every fault is one message, and nothing is read without a limit."""
