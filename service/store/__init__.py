"""The store as one thing: database, caches, kernels, keys, quotas, events."""
