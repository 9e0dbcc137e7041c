"""What commands show on a terminal while they run, and the completion of their words in a shell."""
