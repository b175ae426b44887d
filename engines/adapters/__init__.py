"""One file an engine: how a scene is built, set, stepped and read back."""
