"""Motions of trees over time: integration, inputs, events, and the checks that judge what was computed."""
