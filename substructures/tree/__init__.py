"""Stored parts coupled into one model: payloads from the leaves, twists from the root, certificate of the whole."""
