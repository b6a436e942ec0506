"""The names that robot formats have, by element: what is misspelt or misplaced in a file is told, and not lost."""
