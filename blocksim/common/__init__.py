"""What everything else rests on: errors, files, processes, progress."""
