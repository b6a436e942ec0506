"""Content of the store as bytes: named by digests, checked when read, packed, compared, bundled."""
