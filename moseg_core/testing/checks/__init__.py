"""What each kind of component promises, a module of checks for each."""
