"""Writing of files: names, private folders, locks and permissions; ``files.whole_file`` uses them all."""
