"""Writing of files: whole or not at all, by a private folder, with the permissions of the file replaced."""
