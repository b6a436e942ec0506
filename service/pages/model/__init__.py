"""The pages of one part and of one tree: view, sliders, formulas with their numbers."""
