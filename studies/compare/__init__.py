"""One block, one motion of its base, every source side by side."""
