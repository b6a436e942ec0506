"""Steps of differential equations: whose sizes methods choose, or of one size; where quantities pass a level."""
