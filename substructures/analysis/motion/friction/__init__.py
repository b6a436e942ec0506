"""Dry friction along motions: joints that stick exactly, and friction by the load that joints transmit."""
