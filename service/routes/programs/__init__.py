"""Programs that leave or run: exports, kernels, and what pages in a browser compute with."""
