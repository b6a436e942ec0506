"""What goes from store to store: bundles, mirrors, and where a part came from."""
