"""The pages: one about a folder of results, and those of the published ones."""
